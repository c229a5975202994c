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

/**
 * Give the focus to the slider of the longest overlap, or of the duration that stands in its place, so that the
 * arrow keys change it. Both carry the class "keyed"; a slider beside them may still be on its way out.
 */
export function focusOverlap(root) {
  const shown = deepFind(root, (e) => e.classList.contains("keyed") && e.checkVisibility());
  const inside = shown && deepFind(shown.shadowRoot ?? shown, (e) => e.tagName === "INPUT" && e.type === "range");
  inside?.focus();
}
