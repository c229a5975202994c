/**
 * The weighting function g(u) and what it does: left the curve with handles to drag, right the peak
 * acceleration of the selected join for every weighting function and overlap.
 */
import { drawUnused, drawWeights, handlesOn, moveHandle } from "./curve_edit.js";
import { drawEffect } from "./effect_draw.js";
import { fitText } from "./lane_axes.js";

const REACH_PX = 14;
const STEP = 0.02;

function floats(buffer) {
  if (!buffer?.byteLength) return new Float32Array(0);
  return new Float32Array(buffer instanceof ArrayBuffer ? buffer : buffer.slice().buffer);
}

/** Drag of the handles and their keys; `tell(points)` is called with every move, `dropped()` after a drag. */
class Handles {
  constructor(canvas, box, tell, dropped) {
    Object.assign(this, { canvas, box, tell, dropped, points: [], chosen: -1, drag: false });
    canvas.onpointerdown = (event) => this.down(event);
    canvas.onpointermove = (event) => this.move(event);
    canvas.onpointerup = canvas.onpointercancel = () => this.drop();
  }

  near(event) {
    const [x0, y0, x1, y1] = this.box();
    const far = this.points.map(([u, g]) =>
      Math.hypot(x0 + u * (x1 - x0) - event.offsetX, y1 - g * (y1 - y0) - event.offsetY),
    );
    const index = far.indexOf(Math.min(...far));
    return far[index] <= REACH_PX ? index : -1;
  }

  down(event) {
    this.chosen = this.near(event);
    this.drag = this.chosen >= 0;
    if (this.drag) this.canvas.setPointerCapture(event.pointerId);
  }

  move(event) {
    this.canvas.style.cursor = this.drag || this.near(event) >= 0 ? "grab" : "";
    if (!this.drag) return;
    const [x0, y0, x1, y1] = this.box();
    this.put((event.offsetX - x0) / (x1 - x0), (y1 - event.offsetY) / (y1 - y0));
  }

  drop() {
    this.drag = false;
    this.dropped();
  }

  put(u, g) {
    this.points = moveHandle(this.points, this.chosen, u, g);
    this.tell(this.points);
  }

  /** Tab goes from handle to handle, arrows move it; true when the key was used. */
  key(event) {
    const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (event.key === "PageDown" || event.key === "PageUp") {
      const n = this.points.length;
      this.chosen = (this.chosen + (event.key === "PageDown" ? 1 : n - 1) + n) % n;
      return true;
    }
    if (!by || !this.points.length || event.altKey) return false;
    this.chosen = Math.max(0, this.chosen);
    const [u, g] = this.points[this.chosen];
    const step = event.shiftKey ? STEP / 4 : STEP;
    this.put(u + by[0] * step, g + by[1] * step);
    return true;
  }
}

/** Panel entry point. */
export function renderCurve({ model, el }) {
  el.style.width = el.style.height = "100%";
  const root = document.createElement("div");
  root.className = "vsw-curve";
  const canvas = document.createElement("canvas");
  canvas.setAttribute("role", "application");
  canvas.tabIndex = 0;
  root.append(canvas);
  const ctx = canvas.getContext("2d", { willReadFrequently: true }); // small, and drawn in every step of a drag
  let asked = 0;
  const half = () => Math.round(0.54 * root.clientWidth);
  const box = () => [34, 12, half() - 12, root.clientHeight - 36];
  const tell = (points) => {
    model.send_msg({ type: "points", points });
    ask();
  };

  const handles = new Handles(canvas, box, tell, () => ask());

  const draw = () => {
    asked = 0;
    const [w, h] = [root.clientWidth, root.clientHeight];
    if (w < 80 || h < 80) return;
    const ratio = globalThis.devicePixelRatio || 1;
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    const p = model.palettes[model.theme];
    ctx.fillStyle = p.panel;
    ctx.fillRect(0, 0, w, h);
    const values = floats(model.values);
    if (!handles.drag) handles.points = model.points.length ? model.points : handlesOn(values);
    const chosen = handles.chosen;
    const data = { values, other: floats(model.other_values), handles: handles.points, chosen };
    ctx.globalAlpha = model.unused ? 0.3 : 1;
    if (model.unused) handles.points = data.handles = [];
    drawWeights(ctx, box(), data, p);
    ctx.globalAlpha = 1;
    drawUnused(ctx, box(), model.unused, p);
    ctx.font = `600 12px ${p.family}`;
    const across = w - half() - 16;
    if (ctx.measureText(model.title).width > across) ctx.font = `600 11px ${p.family}`;
    ctx.textAlign = "left";
    ctx.fillStyle = p.ink;
    ctx.fillText(fitText(ctx, model.title, across), half() + 8, 20);
    drawEffect(ctx, [half() + 30, 32, w - 16, h - 52], { ...model.effect, known: Boolean(model.title) }, p);
    ctx.font = `400 11px ${p.family}`;
    ctx.textAlign = "left";
    ctx.fillStyle = p.acc;
    ctx.fillText(fitText(ctx, model.hint, w - half() - 16), half() + 8, h - 6);
    canvas.vsw = { draws: (canvas.vsw?.draws ?? 0) + 1, handles, box, values };
  };
  const ask = () => (asked ||= requestAnimationFrame(draw));
  const describe = () => {
    canvas.setAttribute(
      "aria-label",
      `Weighting function ${model.label}. Page down chooses a handle, arrows move it. ${model.title}: ${
        model.effect.now ? model.effect.now.ratio?.toFixed(2) : "no joins"
      }. ${model.hint}`,
    );
    ask();
  };
  canvas.addEventListener("keydown", (event) => {
    if (!handles.key(event)) return;
    event.preventDefault();
    event.stopPropagation();
    ask();
  });
  for (const name of ["values", "other_values", "points", "effect", "label", "title", "hint", "unused"]) {
    model.on(name, describe);
  }
  model.on("theme", ask);
  const watch = new ResizeObserver(ask);
  watch.observe(root);
  model.on("remove", () => {
    watch.disconnect();
    cancelAnimationFrame(asked);
  });
  describe();
  return root;
}
