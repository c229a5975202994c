/**
 * The joins row of the lane: one badge for every join in view, none on another; pure functions.
 */
import { toX } from "./lane_axes.js";

const GAP = 3;
const PAD = 12;
/** A join whose number has no room keeps a mark this wide, px. */
const MARK = 7;

/** Set `left` of badges so that they keep their order, do not overlap, and lie near their joins (`x`). */
function spread(badges, low, high) {
  const before = [];
  let total = 0;
  for (const b of badges) {
    before.push(total);
    total += b.w + GAP;
  }
  // nearest places in the sense of least squares that keep the order: pool neighbours that would overlap
  const pools = [];
  badges.forEach((b, i) => {
    pools.push({ sum: b.x - b.w / 2 - before[i], n: 1 });
    while (pools.length > 1) {
      const [a, c] = pools.slice(-2);
      if (a.sum / a.n <= c.sum / c.n) break;
      pools.splice(-2, 2, { sum: a.sum + c.sum, n: a.n + c.n });
    }
  });
  let i = 0;
  for (const pool of pools) {
    const at = Math.min(Math.max(pool.sum / pool.n, low), high - (total - GAP));
    for (let k = 0; k < pool.n; k += 1, i += 1) badges[i].left = at + before[i];
  }
}

function width(badges) {
  return badges.reduce((sum, b) => sum + b.w + GAP, -GAP);
}

/** What a badge says: long with the phone and the other setting, short without. */
function texts(join) {
  if (join.ratio === null) return [`${join.phone} –`, "–"];
  const sign = join.ratio > 1 ? "▲ " : "";
  const other = join.other ?? null;
  const now = `${sign}${other === null ? "" : `${other.toFixed(2)} → `}${join.ratio.toFixed(2)}`;
  return [`${join.phone} ${now}`, `${sign}${join.ratio.toFixed(2)}`];
}

/**
 * Places of the badges of all joins in view. Where numbers do not fit, marks stand for those that are within the
 * natural range and not selected; then for all but the selected ones.
 * @param {number} chosen index of the selected fragment
 * @param {string} family typeface
 * @returns {{index: number, x: number, left: number, w: number, text: string, high: boolean, near: boolean}[]}
 */
export function placeBadges(ctx, box, view, joins, chosen, family) {
  ctx.font = `600 11px ${family}`;
  const badges = [];
  joins.forEach((join, index) => {
    const x = toX(box, view, join.time);
    if (x < box.left || x > box.right) return;
    const near = index === chosen || index === chosen - 1;
    badges.push({ index, x, near, high: join.ratio !== null && join.ratio > 1, known: join.ratio !== null });
  });
  const write = (long, shown) => {
    for (const b of badges) {
      b.text = shown(b) ? texts(joins[b.index])[long(b) ? 0 : 1] : "";
      b.w = b.text ? ctx.measureText(b.text).width + PAD : MARK;
    }
  };
  const room = box.right - box.left;
  const tries = [
    [() => true, () => true, 0.5],
    [(b) => b.near, () => true, 0.9],
    [() => false, () => true, 1],
    [() => false, (b) => b.high || b.near, 1],
    [() => false, (b) => b.near, 1],
  ];
  for (const [long, shown, share] of tries) {
    write(long, shown);
    if (width(badges) <= share * room) break;
  }
  spread(badges, box.left, box.right);
  return badges;
}

/** Draw the badges, each tied to its join where it had to move aside. */
export function drawBadges(ctx, box, badges, p) {
  const [top, bottom] = box.joins;
  ctx.textAlign = "center";
  for (const { x, left, w, text, high, near, known } of badges) {
    const edge = near ? p.acc : high ? p.warn : p.line;
    const ink = high ? p.warn : known ? p.ok : p.ink;
    const middle = left + w / 2;
    if (Math.abs(middle - x) > 3) {
      ctx.strokeStyle = near ? p.acc : p.ink3;
      ctx.beginPath();
      ctx.moveTo(x, top - 7);
      ctx.lineTo(middle, top + 2);
      ctx.stroke();
    }
    if (!text) {
      ctx.fillStyle = ink;
      ctx.fillRect(left + 1, top + 5, w - 2, bottom - top - 10);
      continue;
    }
    ctx.fillStyle = high ? p.warn_ground : p.panel;
    ctx.fillRect(left, top + 2, w, bottom - top - 4);
    ctx.strokeStyle = edge;
    ctx.strokeRect(left + 0.5, top + 2.5, w - 1, bottom - top - 5);
    ctx.font = `600 11px ${p.family}`;
    ctx.fillStyle = ink;
    ctx.fillText(text, middle, top + 16);
  }
}
