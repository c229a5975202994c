/**
 * Places of the lane's rows, its time axis, and small helpers of drawing; pure functions.
 */

/** Width in px of the column that names the rows. */
export const GUTTER = 76;

const ROWS = { axis: 20, phones: 34, gap: 6, fragments: 38, others: 20, joins: 26 };

/**
 * @param {number} width @param {number} height CSS px of the canvas
 * @returns rows of the lane, in px
 */
export function layOut(width, height) {
  const phones = ROWS.axis;
  const fragments = phones + ROWS.phones + ROWS.gap;
  const others = fragments + ROWS.fragments + 3;
  const curve = others + ROWS.others + ROWS.gap;
  const joins = height - ROWS.joins;
  return {
    width,
    height,
    left: GUTTER,
    right: width - 8,
    axis: [0, ROWS.axis],
    phones: [phones, phones + ROWS.phones],
    fragments: [fragments, fragments + ROWS.fragments],
    others: [others, others + ROWS.others],
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

/** Fill a box with a colour at some opacity. */
export function tint(ctx, colour, alpha, x, y, w, h) {
  ctx.save();
  ctx.globalAlpha = alpha;
  ctx.fillStyle = colour;
  ctx.fillRect(x, y, w, h);
  ctx.restore();
}
