// Elements from names and texts; no markup is ever parsed.

const svg = "http://www.w3.org/2000/svg";

/// make("li", { class: "led" }, child, "text"); "svg:rect" makes an element of SVG.
export function make(name, attributes = {}, ...children) {
  const element = name.startsWith("svg:") ? document.createElementNS(svg, name.slice(4)) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/// Touches the page only when something changes.
export function set_text(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/// Brings the children of `list` in line with `items`; a child that stays is kept, with its focus. Items with one key are told apart by their order.
export function keep_children(list, items, key, make_child, fill) {
  const times = new Map();
  const present = new Map([...list.children].map((child) => [child.dataset.key, child]));
  let place = list.firstElementChild;
  for (const item of items) {
    const own = key(item);
    const time = times.get(own) ?? 0;
    times.set(own, time + 1);
    const name = time === 0 ? own : `${own}\u0000${time}`;
    let child = present.get(name);
    present.delete(name);
    if (!child) {
      child = make_child(own, item);
      child.dataset.key = name;
    }
    if (child === place) place = place.nextElementSibling;
    else list.insertBefore(child, place);
    fill(child, item);
  }
  for (const child of present.values()) child.remove();
}
