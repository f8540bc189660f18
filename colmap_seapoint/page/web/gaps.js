// The gaps as entries of a list: what is missing, why, what it looks like there, how to close it.
const listedAtFirst = 12;

const turnText = (section, degrees) => section.is_north_up ? `heading ${degrees}°` :
  `heading ${degrees}° from the map's up, clockwise`;
const tiltText = (degrees) => degrees < 20 ? 'camera straight down' :
  degrees > 160 ? 'camera straight up' : `camera tilted by ${degrees}° from straight down`;

const passText = (section, { pass }) =>
  `${plural(pass.lines, 'line', 'lines')}, ${lengthText(pass.length, section.unit)} in all, ` +
  `${turnText(section, pass.heading_deg)}, ${lengthText(pass.altitude, section.unit)} above the ground, ` +
  `${tiltText(pass.tilt_deg)}: ${plural(pass.pictures, 'picture', 'pictures')}`;

const gapPicture = (section, gap, picture) => {
  const text = `${picture.shows_gap ? 'Gap ' + gap.id + ' in' : 'Near gap ' + gap.id + ':'} picture ${picture.name}`;
  const ring = (points) => 'M' + points.map(([x, y]) => `${x} ${y}`).join('L') + 'Z';
  const d = picture.outline.map(ring).join('');
  return make('figure', {},
    draw('svg', { viewBox: `0 0 ${picture.width} ${picture.height}`, role: 'img', 'aria-label': text },
      draw('image', { href: picture.src, width: picture.width, height: picture.height }),
      draw('path', { d, fill: 'none', stroke: '#000', 'stroke-width': 4 }),
      draw('path', { d, fill: 'none', stroke: '#fff', 'stroke-width': 2, 'stroke-dasharray': '7 4' })),
    make('figcaption', {}, picture.name + (picture.shows_gap ? '' : ' (next to it)')));
};

const gapEntry = (section, gap, stop, map) => make('li', { class: 'gap', id: `gap-${section.index}-${gap.id}`, tabindex: '-1' },
  make('h4', {}, causeSwatch(section, gap.cause), `Gap ${gap.id}: ${section.causes[gap.cause].text}`),
  make('p', {}, `${areaText(gap.area, section.unit)}, ${gap.layer === 'top' ? 'on the ground' : 'on the side ' + gap.layer}` +
    `, at ${gap.place}${section.is_geographic ? ' (latitude, longitude, altitude)' : ''}`),
  make('div', { class: 'pictures' }, gap.pictures.map((picture) => gapPicture(section, gap, picture))),
  gap.pictures.length === 0 && gap.names.length > 0 && make('p', {}, 'Next to ' + gap.names.slice(0, 3).join(', ')),
  make('p', {}, make('strong', {}, `Stop ${stop} of the route: `), passText(section, gap)),
  make('p', {}, make('button', { type: 'button', onclick: () => {
    map.view.show(boxOf(gap.outline.flat()));
    map.figure.scrollIntoView({ block: 'nearest' });
  } }, 'Show on the map', make('span', { class: 'hidden-text' }, ` gap ${gap.id}`))));

const gapRow = (section, gap, stop) => [String(gap.id), section.causes[gap.cause].text,
  areaText(gap.area, section.unit), gap.names.slice(0, 2).join(', '), String(stop), passText(section, gap)];

const makeGaps = (section, map) => {
  const stops = new Map(section.route.map((stop, k) => [stop.gap, k + 1]));
  const entry = (gap, k) => gapEntry(section, gap, stops.get(k), map);
  const first = section.gaps.slice(0, listedAtFirst), rest = section.gaps.slice(listedAtFirst);
  const list = make('ol', { class: 'gaps', 'aria-label': 'Gaps' }, first.map(entry));
  if (rest.length === 0) return make('div', {}, list);
  const more = make('button', { type: 'button', class: 'main', onclick: () => {
    list.append(...rest.map((gap, k) => entry(gap, k + listedAtFirst)));
    more.remove();
  } }, `Show the other ${rest.length}`);
  list.showAll = () => more.isConnected && more.click();
  return make('div', {}, list, more, make('details', {}, make('summary', {}, 'All gaps as a table'),
    table('Gaps, most area for a way first', [{ text: 'id', isNumber: true }, 'why', { text: 'area', isNumber: true },
      'pictures next to it', { text: 'stop', isNumber: true }, 'pass'],
    section.gaps.map((gap, k) => gapRow(section, gap, stops.get(k))))));
};
