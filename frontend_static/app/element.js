/**
 * Make a DOM element. Attributes that are functions become listeners, true and false become present and absent; text is
 * always set as text, never as markup.
 */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(name, value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

/** Give an element these children in this order, without moving those that it has: what has focus keeps it. */
export function arrange(parent, children) {
  for (const child of [...parent.children]) if (!children.includes(child)) child.remove();
  let next = parent.firstElementChild;
  for (const child of children) {
    if (child === next) next = next.nextElementSibling;
    else parent.insertBefore(child, next);
  }
}

/** Set an element's text only when it differs: no needless layout, no repeated announcement. */
export function setText(target, text) {
  if (target.textContent !== text) target.textContent = text;
}
