/**
 * The lane of a synthesised utterance on the shared clock: target phones, chosen fragments with their source,
 * lip aperture now and as recorded, joins. Click selects a fragment, drag on the curve seeks, wheel zooms.
 */
import { clock } from "./clock.js";
import { layOut, toTime, toX } from "./lane_axes.js";
import { drawLane } from "./lane_draw.js";
import { Window, buildList, chipAt, readCurves, tooltipText } from "./lane_parts.js";

/** Panel entry point. */
export function renderLane({ model, el }) {
  el.style.width = el.style.height = "100%";
  const root = document.createElement("div");
  root.className = "vsw-lane";
  const canvas = document.createElement("canvas");
  canvas.setAttribute("role", "img");
  const cursor = document.createElement("div");
  cursor.className = "vsw-lane-cursor";
  const tip = document.createElement("div");
  tip.className = "vsw-lane-tip";
  tip.hidden = true;
  const clk = clock(model.session);
  const window_ = new Window(model.score.duration);
  const state = { box: layOut(600, 300), curves: readCurves(model), draws: 0 };
  const ctx = canvas.getContext("2d");
  let asked = 0;

  const draw = () => {
    asked = 0;
    const [w, h] = [root.clientWidth, root.clientHeight];
    if (w < 40 || h < 40) return;
    const ratio = globalThis.devicePixelRatio || 1;
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
      canvas.width = Math.round(w * ratio);
      canvas.height = Math.round(h * ratio);
    }
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    Object.assign(state, { box: layOut(w, h), view: window_.range, score: model.score, joins: model.joins });
    state.selected = model.selected;
    drawLane(ctx, state.box, state.view, state, model.palettes[model.theme]);
    state.draws += 1;
    moveCursor(clk.t);
  };
  const ask = () => (asked ||= requestAnimationFrame(draw));
  let telling = false;
  const moved = () => {
    telling = true;
    clk.setView(window_.shared);
    telling = false;
    ask();
  };
  const follow = () => {
    if (telling) return;
    if (clk.view) window_.set(clk.view[0], clk.view[1] - clk.view[0]);
    else window_.fit(model.score.duration);
    ask();
  };
  clk.addEventListener("view", follow);

  const counted = (n, noun) => `${n} ${noun}${n === 1 ? "" : "s"}`;
  const moveCursor = (t) => {
    const x = toX(state.box, window_.range, t);
    cursor.hidden = x < state.box.left - 1 || x > state.box.right + 1;
    cursor.style.transform = `translateX(${x.toFixed(2)}px)`;
    cursor.style.backgroundColor = model.palettes[model.theme].cursor;
    if (clk.playing && cursor.hidden && x > state.box.right) {
      window_.pan(t - window_.range[0]);
      moved();
    }
  };

  const select = (index) => {
    const n = model.score.fragments.length;
    if (!n || !state.score) return;
    model.selected = Math.min(n - 1, Math.max(0, index));
    if (!clk.playing) clk.seek(model.score.fragments[model.selected].start);
  };
  const { list, draw: drawList } = buildList(model, select);
  const describe = () => {
    const s = model.score;
    canvas.setAttribute(
      "aria-label",
      `${counted(s.phones.length, "phone")} spoken by ${counted(s.fragments.length, "fragment")}, ` +
        `${counted(model.joins.length, "join")}, lip aperture`,
    );
    drawList();
    ask();
  };

  canvas.onpointerdown = (event) => {
    const y = event.offsetY;
    const t = toTime(state.box, window_.range, event.offsetX);
    list.focus({ preventScroll: true });
    if (y >= state.box.fragments[0] && y <= state.box.fragments[1]) {
      const index = model.score.fragments.findIndex((f) => t >= f.start && t < f.end);
      if (index >= 0) select(index);
      return;
    }
    const chip = y >= state.box.others[0] && y <= state.box.others[1] && chipAt(state, event.offsetX);
    if (chip) {
      model.send_msg({ type: "swap", fragment: chip.index, option: chip.option + 1 });
      return;
    }
    if (y >= state.box.joins[0]) {
      const near = model.joins.findIndex(
        (j) => Math.abs(toX(state.box, window_.range, j.time) - event.offsetX) < 28,
      );
      if (near >= 0) select(near + 1);
      return;
    }
    canvas.setPointerCapture(event.pointerId);
    state.drag = event.shiftKey || event.button === 1 ? { pan: event.offsetX } : { seek: true };
    if (state.drag.seek) seek(event.offsetX);
  };
  const seek = (x) =>
    clk.seek(Math.min(model.score.duration, Math.max(0, toTime(state.box, window_.range, x))));
  canvas.onpointermove = (event) => {
    const { drag } = state;
    if (drag?.seek) seek(event.offsetX);
    if (drag?.pan !== undefined) {
      const perPx = (window_.range[1] - window_.range[0]) / (state.box.right - state.box.left);
      window_.pan((drag.pan - event.offsetX) * perPx);
      drag.pan = event.offsetX;
      moved();
    }
    const text = state.score ? tooltipText(state, event.offsetX, event.offsetY) : "";
    tip.hidden = !text;
    tip.textContent = text || "";
    const left = Math.min(event.offsetX + 12, Math.max(0, root.clientWidth - tip.offsetWidth - 4));
    tip.style.transform = `translate(${left}px, ${Math.max(0, event.offsetY - 28)}px)`;
  };
  canvas.onpointerup = canvas.onpointercancel = () => (state.drag = null);
  canvas.onpointerleave = () => (tip.hidden = true);
  canvas.ondblclick = () => {
    window_.fit(model.score.duration);
    moved();
  };
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const across = event.shiftKey ? event.deltaY : event.deltaX;
      const perPx = (window_.range[1] - window_.range[0]) / (state.box.right - state.box.left);
      if (across) window_.pan(across * perPx);
      else window_.zoom(Math.exp(event.deltaY * 0.0015), toTime(state.box, window_.range, event.offsetX));
      moved();
    },
    { passive: false },
  );

  const act = {
    zoom_in: () => window_.zoom(0.6, clk.t),
    zoom_out: () => window_.zoom(1 / 0.6, clk.t),
    fit: () => window_.fit(model.score.duration),
    next_join: () => select(model.selected + 1),
    previous_join: () => select(model.selected - 1),
    frame_on: () => clk.seek(Math.min(model.score.duration, clk.t + 1 / state.curves.rate)),
    frame_back: () => clk.seek(Math.max(0, clk.t - 1 / state.curves.rate)),
  };
  const onKey = (event) => {
    const run = act[event.detail.binding];
    if (!run) return;
    event.detail.handled = true;
    run();
    moved();
  };
  clk.addEventListener("key", onKey);
  const off = clk.add((t) => moveCursor(t));

  model.on("score", () => {
    if (Math.abs(window_.duration - model.score.duration) > 1e-6) {
      window_.fit(model.score.duration);
      moved();
    }
    describe();
  });
  model.on("joins", describe);
  model.on("selected", describe);
  model.on("theme", ask);
  for (const name of ["curves", "band"]) {
    model.on(name, () => {
      state.curves = readCurves(model);
      ask();
    });
  }
  const watch = new ResizeObserver(ask);
  watch.observe(root);
  canvas.vsw = { state, window: window_, toX: (t) => toX(state.box, window_.range, t) };
  model.on("remove", () => {
    watch.disconnect();
    off();
    clk.removeEventListener("key", onKey);
    clk.removeEventListener("view", follow);
    cancelAnimationFrame(asked);
  });
  root.append(canvas, cursor, tip, list);
  describe();
  return root;
}
