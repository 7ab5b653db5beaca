// AG Grid writes its style sheets into <style> elements, which the page's policy refuses. They are written into an element that is not in the document,
// and what it has is adopted as constructed style sheets, which the policy allows.

let container: HTMLElement | null = null;
const ours = new WeakSet<CSSStyleSheet>();

function adopt(elements: Iterable<HTMLStyleElement>): void {
  const sheets = [...elements].map((element) => {
    const sheet = new CSSStyleSheet();
    sheet.replaceSync(element.textContent ?? "");
    ours.add(sheet);
    return sheet;
  });
  document.adoptedStyleSheets = [...document.adoptedStyleSheets.filter((one) => !ours.has(one)), ...sheets];
}

export function style_container(): HTMLElement {
  if (container) return container;
  const box = document.createElement("div");
  const adopt_all = (): void => adopt(box.querySelectorAll("style"));
  // At once where an element comes, as the grid measures what its style sheets say right behind; later where one changes or goes.
  const follow = (element: Element): void => {
    element.after = (...nodes: (Node | string)[]): void => {
      Element.prototype.after.apply(element, nodes);
      for (const node of nodes) if (node instanceof Element) follow(node);
      adopt_all();
    };
  };
  box.insertBefore = <T extends Node>(node: T, before: Node | null): T => {
    HTMLElement.prototype.insertBefore.call(box, node, before);
    if (node instanceof Element) follow(node);
    adopt_all();
    return node;
  };
  new MutationObserver(adopt_all).observe(box, { childList: true, subtree: true, characterData: true });
  container = box;
  return box;
}
