/**
 * Drawing of the lane: target phones, chosen fragments, lip aperture and joins on one time axis.
 * Pure functions of a layout, data and colours; nothing here listens or keeps anything.
 */
import { fitText, niceStep, tint, toX } from "./lane_axes.js";
import { drawAperture } from "./lane_curve.js";
import { drawBadges, placeBadges } from "./lane_joins.js";

function drawGutter(ctx, box, p) {
  const names = [
    ["phones", "Target", "phones"],
    ["fragments", "Chosen", "source"],
    ["others", "Others", ""],
    ["curve", "Aperture", "mm"],
    ["joins", "Joins: peak", "÷ natural p95"],
  ];
  ctx.textAlign = "left";
  for (const [row, title, hint] of names) {
    const y = box[row][0];
    ctx.fillStyle = p.ink;
    ctx.font = `600 11px ${p.family}`;
    ctx.fillText(title, 10, y + 12);
    ctx.fillStyle = p.ink3;
    ctx.font = `400 10px ${p.family}`;
    if (hint) ctx.fillText(hint, 10, y + 24);
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

function drawPin(ctx, fragment, a, b, top, p) {
  if (!fragment.pinned) return;
  ctx.font = `500 11px ${p.family}`;
  ctx.fillStyle = p.acc;
  const long = ctx.measureText("pinned").width;
  const idEnd = a + 6 + ctx.measureText(fragment.id).width + 10;
  ctx.textAlign = "right";
  if (b - 6 - long > idEnd) ctx.fillText("pinned", b - 6, top + 16);
  else ctx.fillRect(b - 6, top + 6, 3, 8);
  ctx.textAlign = "left";
}

/**
 * The units that were turned down, as chips under the fragment that they could replace.
 * @returns {{index: number, option: number, x: number, w: number, id: string}[]} those that have room
 */
export function placeOthers(ctx, box, view, fragments, p) {
  ctx.font = `400 10px ${p.family}`;
  const chips = [];
  fragments.forEach((f, index) => {
    const end = Math.min(box.right, toX(box, view, f.end)) - 2;
    let x = Math.max(box.left, toX(box, view, f.start)) + 2;
    f.others.forEach((id, k) => {
      const w = ctx.measureText(id).width + 10;
      if (x + w > end) x = Infinity;
      else chips.push({ index, option: k, x, w, id });
      x += w + 4;
    });
  });
  return chips;
}

function drawOthers(ctx, box, chips, selected, p) {
  const [top, bottom] = box.others;
  ctx.font = `400 10px ${p.family}`;
  ctx.textAlign = "left";
  for (const { index, x, w, id } of chips) {
    ctx.strokeStyle = p.line;
    ctx.strokeRect(x + 0.5, top + 2.5, w - 1, bottom - top - 5);
    ctx.fillStyle = index === selected ? p.ink : p.ink2;
    ctx.fillText(id, x + 5, top + 14);
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
    drawPin(ctx, f, a, b, top, p);
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

/** Draw the whole lane. */
export function drawLane(ctx, box, view, data, palette) {
  const { score, joins, selected } = data;
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
  data.chips = placeOthers(ctx, box, view, score.fragments, palette);
  drawOthers(ctx, box, data.chips, selected, palette);
  ctx.restore();
  drawAperture(ctx, box, view, data, palette);
  ctx.save();
  ctx.beginPath();
  ctx.rect(box.left, 0, box.right - box.left, box.height);
  ctx.clip();
  drawOverlaps(ctx, box, view, joins, selected, palette);
  data.badges = placeBadges(ctx, box, view, joins, selected, palette.family);
  drawBadges(ctx, box, data.badges, palette);
  ctx.restore();
}
