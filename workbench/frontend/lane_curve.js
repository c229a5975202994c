/**
 * The lip aperture in the lane: the result and everything it is compared with, on one axis.
 */
import { niceStep, toX } from "./lane_axes.js";

/** Lowest and highest value to show: both curves, zero, and a margin. */
export function valueRange(curves) {
  let low = 0;
  let high = 1;
  for (const values of [curves.blend, curves.recorded, curves.other, curves.band?.high]) {
    for (let i = 0; i < (values?.length ?? 0); i += 1) {
      if (values[i] < low) low = values[i];
      if (values[i] > high) high = values[i];
    }
  }
  return [low - 0.04 * (high - low), high + 0.06 * (high - low)];
}

/** The range of the same diphones in other recordings; broken where there are too few of them. */
function drawBand(ctx, box, view, band, range, p) {
  if (!band?.times?.length) return;
  const [top, bottom] = box.curve;
  const y = (v) => bottom - ((v - range[0]) / (range[1] - range[0])) * (bottom - top);
  ctx.save();
  ctx.globalAlpha = 0.2;
  ctx.fillStyle = p.nat;
  const run = [];
  const fill = () => {
    if (run.length > 1) {
      ctx.beginPath();
      for (const i of run) ctx.lineTo(toX(box, view, band.times[i]), y(band.high[i]));
      for (const i of run.reverse()) ctx.lineTo(toX(box, view, band.times[i]), y(band.low[i]));
      ctx.fill();
    }
    run.length = 0;
  };
  for (let i = 0; i < band.times.length; i += 1) {
    if (Number.isFinite(band.low[i])) run.push(i);
    else fill();
  }
  fill();
  ctx.restore();
}

/** What each fragment would have gone on with, dotted, beyond the joins it is cut at. */
function drawContinuations(ctx, box, view, { curves, score, joins }, range, p) {
  ctx.setLineDash([1.5, 3]);
  ctx.lineCap = "round";
  (curves.pieces ?? []).forEach(({ start, values }, index) => {
    const fragment = score.fragments[index];
    if (!fragment) return;
    const colour = p.sources[fragment.slot % p.sources.length];
    const part = (from, to) => {
      const first = Math.max(0, Math.round((from - start) * curves.rate));
      const last = Math.min(values.length, Math.round((to - start) * curves.rate) + 1);
      if (last - first < 2) return;
      const at = start + first / curves.rate;
      drawCurve(ctx, box, view, values.subarray(first, last), curves.rate, at, range, { colour, width: 1.3 });
    };
    const reach = (join) => (join ? join.overlap / 2 + 0.06 : 0);
    if (index > 0) part(fragment.start - reach(joins[index - 1]), fragment.start);
    if (index < joins.length) part(fragment.end, fragment.end + reach(joins[index]));
  });
  ctx.lineCap = "butt";
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

/** The lip aperture: natural range, recorded, the setting not shown (dashed), each fragment's own continuation, and the blend. */
export function drawAperture(ctx, box, view, data, p) {
  const { curves } = data;
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
  drawBand(ctx, box, view, curves.band, range, p);
  drawCurve(ctx, box, view, curves.recorded, curves.recordedRate, curves.recordedStart, range, grey);
  ctx.setLineDash([5, 4]);
  const dashed = { colour: p.other, width: 1.6 };
  drawCurve(ctx, box, view, curves.other, curves.rate, curves.start, range, dashed);
  drawContinuations(ctx, box, view, data, range, p);
  ctx.setLineDash([]);
  drawCurve(ctx, box, view, curves.blend, curves.rate, curves.start, range, { colour: p.acc, width: 2.4 });
  ctx.restore();
}
