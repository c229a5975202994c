/**
 * The effect plot: the peak acceleration of one join against the overlap, for every weighting function at once,
 * on the natural range of the speaker. Pure functions of a place, data and colours.
 */
import { fitText } from "./lane_axes.js";

const LEAST_RANGE = 2.4;
const LONGEST_S = 0.3;
const NAMES_APART = 20;

function line(ctx, x0, y0, x1, y1) {
  ctx.beginPath();
  ctx.moveTo(x0, y0);
  ctx.lineTo(x1, y1);
  ctx.stroke();
}

/** Value of a curve at an overlap, between the overlaps at which it was measured. */
export function ratioAt(overlaps, ratios, overlap) {
  if (!overlaps.length) return NaN;
  if (overlap <= overlaps[0]) return ratios[0];
  for (let i = 1; i < overlaps.length; i += 1) {
    if (overlap > overlaps[i]) continue;
    const share = (overlap - overlaps[i - 1]) / (overlaps[i] - overlaps[i - 1]);
    return ratios[i - 1] + share * (ratios[i] - ratios[i - 1]);
  }
  return ratios.at(-1);
}

/** Highest value of the axis: room for every point, and for a name above the highest; curves may leave it. */
export function rangeOf({ overlaps, curves, now, other }) {
  const points = now ? curves.map((c) => ratioAt(overlaps, c.ratios, now.overlap)) : [];
  const values = [...points, now?.ratio, other?.ratio].filter(Number.isFinite);
  return Math.max(LEAST_RANGE, 1.15 * Math.max(0, ...values));
}

function drawGround(ctx, [x0, y0, x1, y1], toX, toY, most, axis, p) {
  ctx.fillStyle = p.sunk;
  ctx.fillRect(x0, y0, x1 - x0, y1 - y0);
  ctx.save();
  ctx.globalAlpha = 0.2;
  ctx.fillStyle = p.nat;
  ctx.fillRect(x0, toY(1), x1 - x0, y1 - toY(1));
  ctx.restore();
  ctx.strokeStyle = p.nat;
  line(ctx, x0, toY(1), x1, toY(1));
  ctx.font = `400 10px ${p.family}`;
  ctx.fillStyle = p.ink2;
  ctx.textAlign = "right";
  const every = Math.max(1, Math.round(most / 4));
  for (let v = 0; v < most; v += every) ctx.fillText(String(v), x0 - 6, toY(v) + 3);
  ctx.textAlign = "center";
  for (const ms of [0, 100, 200, 300]) {
    const x = Math.round(toX(ms / 1000)) + 0.5;
    ctx.strokeStyle = p.line2;
    line(ctx, x, y0, x, y1);
    ctx.fillText(String(ms), x, y1 + 14);
  }
  ctx.fillText(axis ?? "longest overlap, ms", 0.5 * (x0 + x1), y1 + 28);
  ctx.textAlign = "left";
  ctx.fillStyle = p.ink3;
  ctx.fillText("natural", x0 + 6, y1 - 6);
}

function drawPoint(ctx, x, y, radius, colour) {
  ctx.fillStyle = colour;
  ctx.beginPath();
  ctx.arc(x, y, radius, 0, 2 * Math.PI);
  ctx.fill();
}

/** Draw a point and its name above or below it; `clear` is how much further off the name stands. */
function drawNamed(ctx, box, x, y, text, colour, p, above, clear = 0) {
  drawPoint(ctx, x, y, 5, colour);
  ctx.font = `600 12px ${p.family}`;
  const right = x + 10 + ctx.measureText(text).width > box[2];
  ctx.textAlign = right ? "right" : "left";
  ctx.fillText(text, x + (right ? -9 : 9), Math.max(box[1] + 12, y + (above ? -7 - clear : 14 + clear)));
}

/**
 * @param box [left, top, right, bottom]
 * @param {{overlaps: number[], curves: {name: string, ratios: number[]}[], now: object, other: object}} data
 *   `now` and `other`: {name, overlap, ratio} of the setting that is shown (`side`) and of the other of A and B
 *   (null: the same; alike: of the same fragments, so that its curve is one of those here)
 */
export function drawEffect(ctx, box, data, p) {
  const [x0, y0, x1, y1] = box;
  const toX = (s) => x0 + (s / LONGEST_S) * (x1 - x0);
  const most = rangeOf(data);
  const toY = (v) => y1 - (v / most) * (y1 - y0);
  drawGround(ctx, box, toX, toY, most, data.axis, p);
  const { now, other } = data;
  if (!now) {
    if (!data.known) return;
    ctx.textAlign = "center";
    ctx.fillText(fitText(ctx, "no joins: one fragment covers all", x1 - x0), 0.5 * (x0 + x1), 0.5 * (y0 + y1));
    return;
  }
  const drawLine = ({ ratios }, colour, width, dash) => {
    ctx.strokeStyle = colour;
    ctx.lineWidth = width;
    ctx.setLineDash(dash);
    ctx.beginPath();
    data.overlaps.forEach((s, i) => Number.isFinite(ratios[i]) && ctx.lineTo(toX(s), toY(ratios[i])));
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.lineWidth = 1;
  };
  ctx.save();
  ctx.beginPath();
  ctx.rect(x0, y0, x1 - x0, y1 - y0);
  ctx.clip();
  for (const c of data.curves) drawLine(c, p.nat, 1, [1.5, 3]);
  const named = (name) => data.curves.find((c) => c.name === name);
  if (other?.alike && named(other.name)) drawLine(named(other.name), p.other, 1.6, [5, 4]);
  if (named(now.name) && !now.moved) drawLine(named(now.name), p.acc, 2.4, []);
  ctx.restore();
  for (const c of data.curves) {
    const ratio = ratioAt(data.overlaps, c.ratios, now.overlap);
    if (Number.isFinite(ratio)) drawPoint(ctx, toX(now.overlap), toY(ratio), 3, p.nat);
  }
  const letters = !other ? ["", ""] : data.side === "A" ? ["B ", "A "] : ["A ", "B "];
  if (other && Number.isFinite(other.ratio)) {
    const text = letters[0] + other.ratio.toFixed(2);
    const [above, apart] = [other.ratio > now.ratio, Math.abs(toY(other.ratio) - toY(now.ratio))];
    // the name of what is shown stands above its point: the other's goes above that when the two would meet
    const clear = above && apart < NAMES_APART ? NAMES_APART - apart : 0;
    drawNamed(ctx, box, toX(other.overlap), toY(other.ratio), text, p.other, p, above, clear);
  }
  if (Number.isFinite(now.ratio)) {
    const high = now.ratio > 1;
    const text = `${letters[1]}${high ? "▲ " : ""}${now.ratio.toFixed(2)}`;
    drawNamed(ctx, box, toX(now.overlap), toY(now.ratio), text, high ? p.warn : p.acc, p, true);
  }
}
