/** Finding elements through shadow roots: what a Panel component draws stands in one of its own. */

/**
 * The first element below `node` that passes `test`, shadow roots included.
 * @param {Element | ShadowRoot} node
 * @param {(element: Element) => boolean} test
 * @returns {Element | null}
 */
export function deepFind(node, test) {
  for (const child of node.querySelectorAll("*")) {
    if (test(child)) return child;
    const inside = child.shadowRoot && deepFind(child.shadowRoot, test);
    if (inside) return inside;
  }
  return null;
}

/** Give the focus to the slider of the longest overlap, or of the duration that stands in its place, so that the arrow keys change it. */
export function focusOverlap(root) {
  const place = deepFind(root, (e) => e.classList.contains("sliders"));
  const slider = place && deepFind(place, (e) => e.tagName === "INPUT" && e.type === "range" && e.checkVisibility());
  slider?.focus();
}
