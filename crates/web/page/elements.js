// Small things that all parts of the page do with its elements.

export const byId = (id) => document.getElementById(id);

// An element with these attributes and children.
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

// The same for parts of a drawing.
export function drawn(name, attributes = {}, ...children) {
  const made = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) {
    made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

// Fills a list with names, one of which is chosen.
export function list(id, names, chosen) {
  const option = (name) => new Option(name, name, name === chosen, name === chosen);
  byId(id).replaceChildren(...names.map(option));
}

// Adds a file's scene to a list in place of another one's.
export function addFile(id, name) {
  const place = byId(id);
  place.querySelector('[data-file]')?.remove();
  const option = new Option(name, name);
  option.dataset.file = '';
  place.prepend(option);
  return place;
}

// Says what is wrong; null for nothing.
export function problem(message) {
  const place = byId('problem');
  place.hidden = message === null;
  place.textContent = message ?? '';
}
