/**
 * Drawing of the lane: target phones, chosen fragments, lip aperture and joins on one time axis.
 * Pure functions of a layout, data and colours; nothing here listens or keeps anything.
 */

/** Width in px of the column that names the rows. */
export const GUTTER = 76;

const ROWS = { axis: 20, phones: 34, gap: 8, fragments: 38, joins: 26 };

/**
 * @param {number} width @param {number} height CSS px of the canvas
 * @returns rows of the lane, in px
 */
export function layOut(width, height) {
  const phones = ROWS.axis;
  const fragments = phones + ROWS.phones + ROWS.gap;
  const curve = fragments + ROWS.fragments + ROWS.gap;
  const joins = height - ROWS.joins;
  return {
    width,
    height,
    left: GUTTER,
    right: width - 8,
    axis: [0, ROWS.axis],
    phones: [phones, phones + ROWS.phones],
    fragments: [fragments, fragments + ROWS.fragments],
    curve: [curve, Math.max(curve + 20, joins - 6)],
    joins: [joins, height - 4],
  };
}

/** Time in seconds -> px. */
export function toX(box, view, t) {
  return box.left + ((t - view[0]) / (view[1] - view[0])) * (box.right - box.left);
}

/** px -> time in seconds. */
export function toTime(box, view, x) {
  return view[0] + ((x - box.left) / (box.right - box.left)) * (view[1] - view[0]);
}

/** A step of 1, 2 or 5 times a power of ten that gives about `count` ticks over `span`. */
export function niceStep(span, count) {
  const raw = span / Math.max(1, count);
  const power = 10 ** Math.floor(Math.log10(raw));
  const lead = raw / power;
  return power * (lead <= 1 ? 1 : lead <= 2 ? 2 : lead <= 5 ? 5 : 10);
}

/** Text cut to `width` with an ellipsis; empty when not even three letters fit. */
export function fitText(ctx, text, width) {
  if (ctx.measureText(text).width <= width) return text;
  let n = text.length;
  while (n > 0 && ctx.measureText(`${text.slice(0, n)}…`).width > width) n -= 1;
  return n >= 3 ? `${text.slice(0, n).trimEnd()}…` : "";
}

function tint(ctx, colour, alpha, x, y, w, h) {
  ctx.save();
  ctx.globalAlpha = alpha;
  ctx.fillStyle = colour;
  ctx.fillRect(x, y, w, h);
  ctx.restore();
}

function drawGutter(ctx, box, p) {
  const names = [
    ["phones", "Target", "phones"],
    ["fragments", "Chosen", "source"],
    ["curve", "Aperture", "mm"],
    ["joins", "Joins", "natural %"],
  ];
  ctx.textAlign = "left";
  for (const [row, title, hint] of names) {
    const y = box[row][0];
    ctx.fillStyle = p.ink;
    ctx.font = `600 11px ${p.family}`;
    ctx.fillText(title, 10, y + 12);
    ctx.fillStyle = p.ink3;
    ctx.font = `400 10px ${p.family}`;
    ctx.fillText(hint, 10, y + 24);
  }
}

function drawAxis(ctx, box, view, p) {
  const step = niceStep(view[1] - view[0], (box.right - box.left) / 110);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  ctx.font = `400 10px ${p.family}`;
  ctx.textAlign = "left";
  for (let k = Math.ceil(view[0] / step - 1e-9); k * step <= view[1] + 1e-9; k += 1) {
    const x = Math.round(toX(box, view, k * step)) + 0.5;
    ctx.strokeStyle = p.line;
    ctx.beginPath();
    ctx.moveTo(x, 2);
    ctx.lineTo(x, box.axis[1]);
    ctx.stroke();
    ctx.fillStyle = p.ink2;
    const text = (k * step).toFixed(digits);
    if (x + 4 + ctx.measureText(text).width < box.right) ctx.fillText(text, x + 4, 13);
  }
}

function drawPhones(ctx, box, view, phones, p) {
  const [top, bottom] = box.phones;
  for (const [start, end, text, kind] of phones) {
    const a = toX(box, view, start);
    const b = toX(box, view, end);
    if (b < box.left || a > box.right) continue;
    const colour = p.classes[kind] ?? p.classes.silence;
    tint(ctx, colour, 0.13, a, top, b - a, bottom - top);
    ctx.fillStyle = colour;
    ctx.fillRect(a + 0.5, top, Math.max(1, b - a - 1), 3);
    ctx.font = `600 13px ${p.family}`;
    if (ctx.measureText(text).width > b - a - 2) ctx.font = `600 10px ${p.family}`;
    if (ctx.measureText(text).width > b - a - 1) continue;
    ctx.fillStyle = kind === "silence" ? p.ink3 : p.ink;
    ctx.textAlign = "center";
    const middle = 0.5 * (Math.max(a, box.left) + Math.min(b, box.right));
    if (Math.min(b, box.right) - Math.max(a, box.left) > 8) ctx.fillText(text, middle, top + 22);
  }
}

function drawFragments(ctx, box, view, fragments, selected, p) {
  const [top, bottom] = box.fragments;
  fragments.forEach((f, index) => {
    const a = Math.max(box.left, toX(box, view, f.start));
    const b = Math.min(box.right, toX(box, view, f.end));
    if (b <= a) return;
    const colour = p.sources[f.slot % p.sources.length];
    tint(ctx, colour, 0.22, a, top, b - a, bottom - top);
    ctx.fillStyle = colour;
    ctx.fillRect(a + 0.5, top, b - a - 1, 3);
    ctx.textAlign = "left";
    ctx.fillStyle = p.ink;
    ctx.font = `600 12px ${p.family}`;
    const mark = f.backoff.length ? "▲ " : "";
    ctx.fillText(fitText(ctx, mark + f.id, b - a - 10), a + 6, top + 17);
    ctx.fillStyle = p.ink2;
    ctx.font = `400 11px ${p.family}`;
    const cost = `cost ${f.cost.toFixed(2)}`;
    const long = f.text ? `“${f.text}”  ${cost}` : cost;
    const shown = [long, cost].find((text) => ctx.measureText(text).width <= b - a - 10);
    ctx.fillText(shown ?? "", a + 6, top + 31);
    if (index !== selected) return;
    ctx.strokeStyle = p.acc;
    ctx.lineWidth = 2;
    ctx.strokeRect(a + 1, top + 1, b - a - 2, bottom - top - 2);
    ctx.lineWidth = 1;
  });
}

function drawOverlaps(ctx, box, view, joins, chosen, p) {
  joins.forEach((join, index) => {
    const a = toX(box, view, join.time - join.overlap / 2);
    const b = toX(box, view, join.time + join.overlap / 2);
    if (b < box.left || a > box.right) return;
    const near = index === chosen || index === chosen - 1;
    const from = box.fragments[0];
    tint(ctx, near ? p.acc : p.nat, near ? 0.14 : 0.16, a, from, b - a, box.joins[0] - from);
    const x = Math.round(toX(box, view, join.time)) + 0.5;
    ctx.strokeStyle = p.ink3;
    ctx.setLineDash([4, 3]);
    ctx.beginPath();
    ctx.moveTo(x, from);
    ctx.lineTo(x, box.joins[0]);
    ctx.stroke();
    ctx.setLineDash([]);
  });
}

/** Lowest and highest value to show: both curves, zero, and a margin. */
export function valueRange(curves) {
  let low = 0;
  let high = 1;
  for (const values of [curves.blend, curves.recorded]) {
    for (let i = 0; i < (values?.length ?? 0); i += 1) {
      if (values[i] < low) low = values[i];
      if (values[i] > high) high = values[i];
    }
  }
  return [low - 0.04 * (high - low), high + 0.06 * (high - low)];
}

function drawCurve(ctx, box, view, values, rate, start, range, style) {
  if (!values?.length) return;
  const [top, bottom] = box.curve;
  const y = (v) => bottom - ((v - range[0]) / (range[1] - range[0])) * (bottom - top);
  const first = Math.max(0, Math.floor((view[0] - start) * rate) - 1);
  const last = Math.min(values.length - 1, Math.ceil((view[1] - start) * rate) + 1);
  ctx.strokeStyle = style.colour;
  ctx.lineWidth = style.width;
  ctx.lineJoin = "round";
  ctx.beginPath();
  for (let i = first; i <= last; i += 1) ctx.lineTo(toX(box, view, start + i / rate), y(values[i]));
  ctx.stroke();
  ctx.lineWidth = 1;
}

function drawAperture(ctx, box, view, curves, p) {
  const [top, bottom] = box.curve;
  const range = valueRange(curves);
  const y = (v) => Math.round(bottom - ((v - range[0]) / (range[1] - range[0])) * (bottom - top)) + 0.5;
  const step = niceStep(range[1] - range[0], (bottom - top) / 34);
  ctx.font = `400 10px ${p.family}`;
  for (let k = Math.ceil(range[0] / step); k * step <= range[1]; k += 1) {
    ctx.strokeStyle = k === 0 ? p.ink3 : p.line2;
    ctx.beginPath();
    ctx.moveTo(box.left, y(k * step));
    ctx.lineTo(box.right, y(k * step));
    ctx.stroke();
    ctx.textAlign = "right";
    ctx.fillStyle = p.ink2;
    ctx.fillText(String(+(k * step).toFixed(6)), box.left - 6, y(k * step) + 3);
  }
  if (curves.threshold !== null && curves.threshold !== undefined) {
    ctx.strokeStyle = p.warn_mark;
    ctx.setLineDash([3, 3]);
    ctx.beginPath();
    ctx.moveTo(box.left, y(curves.threshold));
    ctx.lineTo(box.right, y(curves.threshold));
    ctx.stroke();
    ctx.setLineDash([]);
  }
  ctx.save();
  ctx.beginPath();
  ctx.rect(box.left, top - 2, box.right - box.left, bottom - top + 4);
  ctx.clip();
  const grey = { colour: p.nat, width: 1.6 };
  drawCurve(ctx, box, view, curves.recorded, curves.recordedRate, curves.recordedStart, range, grey);
  drawCurve(ctx, box, view, curves.blend, curves.rate, curves.start, range, { colour: p.acc, width: 2.4 });
  ctx.restore();
}

function drawJoins(ctx, box, view, joins, chosen, p) {
  const [top, bottom] = box.joins;
  ctx.font = `600 11px ${p.family}`;
  ctx.textAlign = "center";
  let edge = -Infinity;
  joins.forEach((join, index) => {
    const x = toX(box, view, join.time);
    if (x < box.left || x > box.right) return;
    const known = join.percentile !== null;
    const high = known && join.percentile > 95;
    const text = `${join.phone} ${known ? `${high ? "▲ " : ""}${join.percentile.toFixed(0)}` : "–"}`;
    const w = ctx.measureText(text).width + 12;
    const left = Math.min(Math.max(x - w / 2, box.left), box.right - w);
    if (left < edge + 3) return;
    edge = left + w;
    ctx.fillStyle = high ? p.warn_ground : p.panel;
    ctx.fillRect(left, top + 2, w, bottom - top - 4);
    const near = index === chosen || index === chosen - 1;
    ctx.strokeStyle = near ? p.acc : high ? p.warn : p.line;
    ctx.strokeRect(left + 0.5, top + 2.5, w - 1, bottom - top - 5);
    ctx.fillStyle = high ? p.warn : p.ink;
    ctx.fillText(text, left + w / 2, top + 16);
  });
}

/** Draw the whole lane. */
export function drawLane(ctx, box, view, data, palette) {
  const { score, joins, curves, selected } = data;
  ctx.clearRect(0, 0, box.width, box.height);
  ctx.fillStyle = palette.panel;
  ctx.fillRect(0, 0, box.width, box.height);
  ctx.fillStyle = palette.sunk;
  ctx.fillRect(box.left, box.curve[0] - 4, box.right - box.left, box.curve[1] - box.curve[0] + 8);
  drawGutter(ctx, box, palette);
  ctx.save();
  ctx.beginPath();
  ctx.rect(box.left, 0, box.right - box.left, box.height);
  ctx.clip();
  drawAxis(ctx, box, view, palette);
  drawPhones(ctx, box, view, score.phones, palette);
  drawFragments(ctx, box, view, score.fragments, selected, palette);
  ctx.restore();
  drawAperture(ctx, box, view, curves, palette);
  ctx.save();
  ctx.beginPath();
  ctx.rect(box.left, 0, box.right - box.left, box.height);
  ctx.clip();
  drawOverlaps(ctx, box, view, joins, selected, palette);
  drawJoins(ctx, box, view, joins, selected, palette);
  ctx.restore();
}
