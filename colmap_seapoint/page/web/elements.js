// Elements, numbers and names. Texts are always set as text, so that a picture's name can hold
// anything.
const svgSpace = 'http://www.w3.org/2000/svg';

const fill = (element, attributes, children) => {
  for (const [name, value] of Object.entries(attributes || {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value === true ? '' : value);
  }
  for (const child of children.flat(2)) {
    if (child === undefined || child === null || child === false || child === '') continue;
    element.append(child);
  }
  return element;
};
const make = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
const draw = (tag, attributes, ...children) =>
  fill(document.createElementNS(svgSpace, tag), attributes, children);

// Three digits that matter, without an exponent.
const digits = (value, count = 3) => {
  if (!Number.isFinite(value)) return '–';
  const rounded = Number(value.toPrecision(count));
  return Math.abs(rounded) >= 1e6 ? rounded.toExponential(2) : String(rounded);
};
const percent = (share, decimals = 1) => (100 * share).toFixed(decimals) + ' %';
const lengthText = (value, unit) => {
  if (unit !== 'm') return digits(value) + ' ' + unit;
  if (Math.abs(value) < 0.01) return digits(1000 * value, 2) + ' mm';
  return Math.abs(value) < 1 ? digits(100 * value, 2) + ' cm' : digits(value) + ' m';
};
const areaUnit = (unit) => unit === 'm' ? 'm²' : 'square units';
const areaText = (value, unit) => `${digits(value)} ${areaUnit(unit)}`;
const secondsText = (seconds) => {
  if (seconds < 60) return seconds.toFixed(1) + ' s';
  const minutes = Math.round(seconds / 60);
  return minutes < 60 ? minutes + ' min' : Math.floor(minutes / 60) + ' h ' + (minutes % 60) + ' min';
};
const plural = (count, one, many) => count + ' ' + (count === 1 ? one : many);
// A picture's name without folder and extension, as one says it.
const shortName = (name) => name.replace(/^.*\//, '').replace(/\.[^.]*$/, '');

const readJson = (element) => JSON.parse(element.textContent);
const bytesOf = (base64) => {
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let k = 0; k < bytes.length; ++k) bytes[k] = text.charCodeAt(k);
  return bytes;
};

const table = (caption, head, rows) =>
  make('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': caption },
    make('table', {}, make('caption', { class: 'note' }, caption),
      make('thead', {}, make('tr', {}, head.map((cell) =>
        make('th', { scope: 'col', class: cell.isNumber && 'number' }, cell.text || cell)))),
      make('tbody', {}, rows.map((row) => make('tr', {}, row.map((cell, k) =>
        make('td', { class: head[k].isNumber && 'number' }, cell)))))));
