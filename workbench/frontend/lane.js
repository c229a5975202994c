/**
 * The lane of a synthesised utterance on the shared clock: target phones, chosen fragments with their source,
 * lip aperture now and as recorded, joins. Click selects a fragment, drag on the curve seeks, wheel zooms.
 */
import { clock } from "./clock.js";
import { drawLane, layOut, toTime, toX } from "./lane_draw.js";

const MIN_SPAN_S = 0.08;

function floats(buffer) {
  if (!buffer?.byteLength) return new Float32Array(0);
  const bytes = buffer instanceof ArrayBuffer ? buffer : buffer.slice().buffer;
  return new Float32Array(bytes);
}

function readCurves(model) {
  const c = model.curves;
  return {
    blend: floats(c.blend),
    rate: c.rate ?? 120,
    start: c.start ?? 0,
    recorded: floats(c.recorded),
    recordedRate: c.recorded_rate ?? 25,
    recordedStart: c.recorded_start ?? 0,
    threshold: c.threshold ?? null,
  };
}

function tooltipText(state, x, y) {
  const { box, view, score, joins, curves } = state;
  const t = toTime(box, view, x);
  if (x < box.left || x > box.right) return "";
  if (y >= box.phones[0] && y <= box.phones[1]) {
    const phone = score.phones.find(([a, b]) => t >= a && t < b);
    return phone && `${phone[2]} · ${phone[0].toFixed(3)}–${phone[1].toFixed(3)} s · ${phone[3]}`;
  }
  if (y >= box.fragments[0] && y <= box.fragments[1]) {
    const f = score.fragments.find((g) => t >= g.start && t < g.end);
    if (!f) return "";
    const backoff = f.backoff.map((b) => `${b[1]} spoken as ${b[2]}`).join(", ");
    return `${f.id} “${f.text}” · phones ${f.phones} · cost ${f.cost.toFixed(2)}${backoff && ` · ▲ ${backoff}`}`;
  }
  const near = joins.find((j) => Math.abs(toX(box, view, j.time) - x) < 24);
  if (y >= box.joins[0] && near) {
    const place =
      near.percentile === null ? "unknown" : `${near.percentile.toFixed(0)} % of natural peaks lie below`;
    return `join at ${near.phone}, ${near.time.toFixed(3)} s · overlap ${(1000 * near.overlap).toFixed(0)} ms · peak acceleration: ${place}`;
  }
  if (y < box.curve[0] || y > box.curve[1]) return "";
  const at = (values, rate, start) => values[Math.round((t - start) * rate)];
  const now = at(curves.blend, curves.rate, curves.start);
  const was = at(curves.recorded, curves.recordedRate, curves.recordedStart);
  const parts = [`${t.toFixed(3)} s`];
  if (now !== undefined) parts.push(`now ${now.toFixed(1)} mm`);
  if (was !== undefined) parts.push(`recorded ${was.toFixed(1)} mm`);
  return parts.join(" · ");
}

/** The fragments as a list that keyboard and screen reader reach. */
function buildList(model, select) {
  const list = document.createElement("ol");
  list.className = "vsw-lane-list";
  list.setAttribute("role", "listbox");
  list.setAttribute("aria-label", "Chosen fragments");
  list.tabIndex = 0;
  const draw = () => {
    list.replaceChildren(
      ...model.score.fragments.map((f, index) => {
        const item = document.createElement("li");
        item.setAttribute("role", "option");
        item.id = `vsw-fragment-${index}`;
        item.setAttribute("aria-selected", String(index === model.selected));
        item.textContent =
          `${index + 1}: ${f.id}, “${f.text}”, phones ${f.phones}, ` +
          `${f.start.toFixed(2)} to ${f.end.toFixed(2)} s, cost ${f.cost.toFixed(2)}`;
        item.onclick = () => select(index);
        return item;
      }),
    );
    list.setAttribute("aria-activedescendant", `vsw-fragment-${model.selected}`);
  };
  list.onkeydown = (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    select(model.selected + step);
  };
  draw();
  return { list, draw };
}

/** Zoom and pan of the window in view; always inside [0, duration]. */
class Window {
  constructor(duration) {
    this.fit(duration);
  }
  fit(duration) {
    this.duration = Math.max(MIN_SPAN_S, duration);
    this.range = [0, this.duration];
  }
  zoom(factor, about) {
    const [a, b] = this.range;
    const span = Math.min(this.duration, Math.max(MIN_SPAN_S, (b - a) * factor));
    const share = (about - a) / (b - a);
    this.set(about - share * span, span);
  }
  pan(seconds) {
    this.set(this.range[0] + seconds, this.range[1] - this.range[0]);
  }
  set(start, span) {
    const held = Math.min(this.duration, Math.max(MIN_SPAN_S, span));
    const first = Math.min(Math.max(0, start), this.duration - held);
    this.range = [first, first + held];
  }
  /** The window as the clock tells it: null when all is in view. */
  get shared() {
    return this.range[1] - this.range[0] > this.duration - 1e-6 ? null : this.range;
  }
}

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
      `${s.phones.length} phones spoken by ${s.fragments.length} fragments, ${model.joins.length} joins, lip aperture`,
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
    window_.fit(model.score.duration);
    moved();
    describe();
  });
  model.on("joins", describe);
  model.on("selected", describe);
  model.on("theme", ask);
  model.on("curves", () => {
    state.curves = readCurves(model);
    ask();
  });
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
