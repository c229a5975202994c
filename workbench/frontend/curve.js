/**
 * The weighting function g(u) and what it does: left the curve of both fragments, right every join's peak
 * acceleration on the natural range of the speaker.
 */
import { fitText } from "./lane_draw.js";

function floats(buffer) {
  if (!buffer?.byteLength) return new Float32Array(0);
  return new Float32Array(buffer instanceof ArrayBuffer ? buffer : buffer.slice().buffer);
}

function line(ctx, x0, y0, x1, y1) {
  ctx.beginPath();
  ctx.moveTo(x0, y0);
  ctx.lineTo(x1, y1);
  ctx.stroke();
}

function drawWeights(ctx, box, values, p) {
  const [x0, y0, x1, y1] = box;
  ctx.fillStyle = p.sunk;
  ctx.fillRect(x0, y0, x1 - x0, y1 - y0);
  ctx.font = `400 10px ${p.family}`;
  ctx.lineWidth = 1;
  for (const share of [0, 0.5, 1]) {
    const x = Math.round(x0 + share * (x1 - x0)) + 0.5;
    const y = Math.round(y1 - share * (y1 - y0)) + 0.5;
    ctx.strokeStyle = share === 0.5 ? p.line2 : p.line;
    line(ctx, x, y0, x, y1);
    line(ctx, x0, y, x1, y);
    ctx.fillStyle = p.ink2;
    ctx.textAlign = "center";
    ctx.fillText(String(share), x, y1 + 14);
    ctx.textAlign = "right";
    ctx.fillText(String(share), x0 - 6, y + 3);
  }
  ctx.textAlign = "center";
  ctx.fillText("u through the overlap", 0.5 * (x0 + x1), y1 + 28);
  const curve = (value, colour, width) => {
    ctx.strokeStyle = colour;
    ctx.lineWidth = width;
    ctx.lineJoin = "round";
    ctx.beginPath();
    for (let i = 0; i < values.length; i += 1) {
      ctx.lineTo(x0 + (i / (values.length - 1)) * (x1 - x0), y1 - value(values[i]) * (y1 - y0));
    }
    ctx.stroke();
    ctx.lineWidth = 1;
  };
  if (values.length < 2) return;
  curve((g) => 1 - g, p.nat, 1.6);
  curve((g) => g, p.acc, 2.4);
  ctx.font = `600 11px ${p.family}`;
  ctx.textAlign = "left";
  ctx.fillStyle = p.acc;
  ctx.fillText("g  out", x0 + 8, y0 + 16);
  ctx.textAlign = "right";
  ctx.fillStyle = p.ink2;
  ctx.fillText("1 − g  in", x1 - 8, y0 + 16);
}

function drawEffect(ctx, box, joins, chosen, p) {
  const [x0, y0, x1, y1] = box;
  const toX = (percent) => x0 + (percent / 100) * (x1 - x0);
  ctx.save();
  ctx.globalAlpha = 0.2;
  ctx.fillStyle = p.nat;
  ctx.fillRect(toX(10), y0, toX(90) - toX(10), y1 - y0);
  ctx.restore();
  ctx.font = `400 10px ${p.family}`;
  ctx.fillStyle = p.ink2;
  ctx.strokeStyle = p.line;
  for (const percent of [0, 50, 95]) {
    const x = Math.round(toX(percent)) + 0.5;
    ctx.strokeStyle = percent === 95 ? p.warn_mark : p.line;
    line(ctx, x, y0, x, y1);
    ctx.textAlign = "center";
    ctx.fillText(String(percent), x, y1 + 14);
  }
  ctx.fillText("natural percentile of the peak", 0.5 * (x0 + x1), y1 + 28);
  const step = Math.min(24, (y1 - y0) / Math.max(1, joins.length));
  joins.forEach((join, index) => {
    const y = y0 + (index + 0.5) * step;
    const near = index === chosen || index === chosen - 1;
    ctx.textAlign = "right";
    ctx.font = `${near ? 600 : 400} 11px ${p.family}`;
    ctx.fillStyle = near ? p.ink : p.ink2;
    if (step >= 10) ctx.fillText(fitText(ctx, join.phone, 60) || join.phone, x0 - 8, y + 4);
    if (join.percentile === null) return;
    const high = join.percentile > 95;
    ctx.strokeStyle = p.line;
    line(ctx, x0, y, toX(join.percentile), y);
    ctx.fillStyle = high ? p.warn : p.acc;
    ctx.beginPath();
    ctx.arc(toX(join.percentile), y, near ? 5 : 3.5, 0, 2 * Math.PI);
    ctx.fill();
    if (!near || step < 12) return;
    ctx.textAlign = join.percentile > 60 ? "right" : "left";
    ctx.fillStyle = high ? p.warn : p.ink;
    const side = join.percentile > 60 ? -10 : 10;
    ctx.fillText(`${high ? "▲ " : ""}${join.percentile.toFixed(0)}`, toX(join.percentile) + side, y + 4);
  });
  if (joins.length) return;
  ctx.textAlign = "center";
  ctx.fillText("no joins: one fragment covers all", 0.5 * (x0 + x1), 0.5 * (y0 + y1));
}

/** Panel entry point. */
export function renderCurve({ model, el }) {
  el.style.width = el.style.height = "100%";
  const root = document.createElement("div");
  root.className = "vsw-curve";
  const canvas = document.createElement("canvas");
  canvas.setAttribute("role", "img");
  root.append(canvas);
  const ctx = canvas.getContext("2d");
  let asked = 0;
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
    const half = Math.round(0.54 * w);
    drawWeights(ctx, [34, 12, half - 12, h - 36], floats(model.values), p);
    ctx.font = `600 12px ${p.family}`;
    ctx.textAlign = "left";
    ctx.fillStyle = p.ink;
    ctx.fillText(fitText(ctx, "Peak acceleration at each join", w - half - 16), half + 8, 20);
    drawEffect(ctx, [half + 36, 32, w - 20, h - 36], model.joins, model.selected, p);
    canvas.vsw = { draws: (canvas.vsw?.draws ?? 0) + 1 };
  };
  const ask = () => (asked ||= requestAnimationFrame(draw));
  const describe = () => {
    const high = model.joins.filter((j) => j.percentile !== null && j.percentile > 95).length;
    canvas.setAttribute(
      "aria-label",
      `Weighting function ${model.label}; ${model.joins.length} joins, ${high} above the natural 95 %`,
    );
    ask();
  };
  for (const name of ["values", "joins", "selected", "label"]) model.on(name, describe);
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
