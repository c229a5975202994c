/**
 * A browser draws about 16 WebGL views of a page and silently drops the oldest beyond that. Views that are out
 * of sight therefore give their context up in time, keeping a picture, and take one again when they are seen.
 */
const LIVE = (globalThis[Symbol.for("vsw.contexts")] ??= new Set());

/** So many may live though some are out of sight; so many in any case. */
const KEPT = 8;
const MOST = 14;

/**
 * A view has a context from now on; others may have to give theirs up.
 * @param {{inSight: boolean, suspend: () => void}} view
 */
export function take(view) {
  LIVE.delete(view);
  LIVE.add(view);
  const others = [...LIVE].filter((v) => v !== view);
  for (const other of others.filter((v) => !v.inSight)) {
    if (LIVE.size <= KEPT) return;
    other.suspend();
  }
  for (const other of others) {
    if (LIVE.size <= MOST) return;
    if (LIVE.has(other)) other.suspend();
  }
}

/** A view has none any more. */
export function give(view) {
  LIVE.delete(view);
}
