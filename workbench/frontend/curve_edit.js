/**
 * The weighting function g(u) with handles: drawing, and where a handle may go. A curve that falls from 1 to 0
 * stays one, because a handle cannot pass its neighbours.
 */

/** Where the handles stand along u. */
export const HANDLES = [0.2, 0.36, 0.5, 0.64, 0.8];
const EDGE = 0.05; // between neighbours along u: closer handles cover each other and bend the curve sharply

/** The value of g at u, from even samples. */
export function sampleAt(values, u) {
  const x = u * (values.length - 1);
  const i = Math.min(values.length - 2, Math.floor(x));
  return values[i] + (x - i) * (values[i + 1] - values[i]);
}

/** Handles on a curve given by even samples: [[u, g], ...]. */
export function handlesOn(values) {
  return values.length < 2 ? [] : HANDLES.map((u) => [u, sampleAt(values, u)]);
}

/** The handles with one of them at (u, g), held between its neighbours. */
export function moveHandle(points, index, u, g) {
  const before = points[index - 1] ?? [0, 1];
  const after = points[index + 1] ?? [1, 0];
  const at = [
    Math.min(after[0] - EDGE, Math.max(before[0] + EDGE, u)),
    Math.min(before[1], Math.max(after[1], g)),
  ];
  return points.map((point, i) => (i === index ? at : point));
}

function drawGrid(ctx, [x0, y0, x1, y1], p) {
  ctx.fillStyle = p.sunk;
  ctx.fillRect(x0, y0, x1 - x0, y1 - y0);
  ctx.font = `400 10px ${p.family}`;
  ctx.lineWidth = 1;
  for (const share of [0, 0.25, 0.5, 0.75, 1]) {
    const x = Math.round(x0 + share * (x1 - x0)) + 0.5;
    const y = Math.round(y1 - share * (y1 - y0)) + 0.5;
    ctx.strokeStyle = share % 1 ? p.line2 : p.line;
    ctx.beginPath();
    ctx.moveTo(x, y0);
    ctx.lineTo(x, y1);
    ctx.moveTo(x0, y);
    ctx.lineTo(x1, y);
    ctx.stroke();
    if ((4 * share) % 2) continue;
    ctx.fillStyle = p.ink2;
    ctx.textAlign = "center";
    ctx.fillText(String(share), x, y1 + 14);
    ctx.textAlign = "right";
    ctx.fillText(String(share), x0 - 6, y + 3);
  }
  ctx.textAlign = "center";
  ctx.fillText("u through the overlap", 0.5 * (x0 + x1), y1 + 28);
}

/**
 * @param box [left, top, right, bottom]
 * @param {{values: Float32Array, other: Float32Array, handles: number[][], chosen: number}} data
 */
export function drawWeights(ctx, box, data, p) {
  const [x0, y0, x1, y1] = box;
  drawGrid(ctx, box, p);
  const curve = (values, of, colour, width, dash) => {
    if (values.length < 2) return;
    ctx.strokeStyle = colour;
    ctx.lineWidth = width;
    ctx.setLineDash(dash);
    ctx.lineJoin = "round";
    ctx.beginPath();
    for (let i = 0; i < values.length; i += 1) {
      ctx.lineTo(x0 + (i / (values.length - 1)) * (x1 - x0), y1 - of(values[i]) * (y1 - y0));
    }
    ctx.stroke();
    ctx.setLineDash([]);
    ctx.lineWidth = 1;
  };
  ctx.save();
  ctx.globalAlpha *= 0.45;
  curve(data.values, (g) => 1 - g, p.acc, 1.4, []);
  ctx.restore();
  curve(data.other, (g) => g, p.other, 1.6, [5, 4]);
  curve(data.values, (g) => g, p.acc, 2.4, []);
  data.handles.forEach(([u, g], index) => {
    const now = index === data.chosen;
    ctx.beginPath();
    ctx.arc(x0 + u * (x1 - x0), y1 - g * (y1 - y0), now ? 6.5 : 5, 0, 2 * Math.PI);
    ctx.fillStyle = now ? p.acc_ground : p.panel;
    ctx.fill();
    ctx.strokeStyle = p.acc;
    ctx.lineWidth = now ? 2.4 : 1.6;
    ctx.stroke();
  });
  ctx.lineWidth = 1;
  ctx.font = `600 11px ${p.family}`;
  ctx.textAlign = "left";
  ctx.fillStyle = p.acc;
  ctx.fillText("out", x0 + 8, y1 - 8 - (y1 - y0) * 0.72);
  ctx.textAlign = "right";
  ctx.fillStyle = p.ink2;
  ctx.fillText("in", x1 - 8, y1 - 8 - (y1 - y0) * 0.72);
}

/** Say over the grey curve why it does nothing. */
export function drawUnused(ctx, [x0, y0, x1, y1], why, p) {
  if (!why) return;
  ctx.font = `600 12px ${p.family}`;
  ctx.textAlign = "center";
  ctx.fillStyle = p.ink2;
  why.split(": ").forEach((part, i) => ctx.fillText(part, 0.5 * (x0 + x1), 0.5 * (y0 + y1) + 16 * i));
}
