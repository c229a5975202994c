/**
 * Notebooks: Panel holds what a widget says back for 50 ms before it sends it to Python. A head that follows a
 * slider should not wait for that; what is said meanwhile is gathered by the comm itself, until Python answers.
 */

/** Let every notebook comm of the page send at once. */
export function hurryComms() {
  for (const doc of globalThis.Bokeh?.documents ?? []) {
    for (const model of doc._all_models?.values() ?? []) {
      if (model.type?.endsWith("CommManager") && model.debounce) model.setv({ debounce: 0 }, { silent: true });
    }
  }
}

/** Do so whenever somebody is about to move something: cells may be run later than that of the head. */
export function hurryOnTouch() {
  if (globalThis.vswHurries) return;
  globalThis.vswHurries = true;
  for (const kind of ["pointerdown", "keydown"]) addEventListener(kind, hurryComms, { capture: true, passive: true });
}
