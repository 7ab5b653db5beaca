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
