// The slate: one A4 page that a diver takes down. Few words, large numbers, pictures of landmarks.
const stopsOnSlate = 8;

const slateStops = (section) => section.route.map((stop, k) => ({ ...section.gaps[stop.gap], number: k + 1,
  reversed: stop.is_reversed })).slice(0, stopsOnSlate);

// Its end tells pictures apart.
const slateName = (name) => {
  const short = shortName(name);
  return short.length > 14 ? '…' + short.slice(-12) : short;
};

const stopCorners = (stop) => stop.reversed ? [...stop.pass.corners].reverse() : stop.pass.corners;
const headingFrom = ([x0, y0], [x1, y1]) => Math.round((Math.atan2(x1 - x0, y1 - y0) * 180 / Math.PI + 360) % 360);
const legText = (section, from, to) => `${lengthText(Math.hypot(to[0] - from[0], to[1] - from[1]), section.unit)} at ${headingFrom(from, to)}°`;

const stopPicture = (stop) => {
  const picture = stop.pictures[0];
  if (!picture) return draw('svg', { viewBox: '0 0 1 1', 'aria-hidden': 'true' });
  return draw('svg', { viewBox: `0 0 ${picture.width} ${picture.height}`, preserveAspectRatio: 'xMidYMid slice', role: 'img',
    'aria-label': `Landmark of gap ${stop.id}, from picture ${picture.name}` },
  draw('image', { href: picture.src, width: picture.width, height: picture.height }));
};

const stopEntry = (section, stop, before) => {
  const corners = stopCorners(stop), names = stop.names.map(slateName);
  return make('li', { class: 'stop' }, stopPicture(stop), make('div', { class: 'words' },
    make('p', { class: 'number' }, `${stop.number}. gap ${stop.id}`),
    before && make('p', {}, 'swim ' + legText(section, before, corners[0])),
    names.length > 0 && make('p', {}, make('strong', {}, 'towards picture ' + names[0]), names[1] ? ', then ' + names[1] : ''),
    make('p', {}, `${plural(stop.pass.lines, 'line', 'lines')}, first ${legText(section, corners[0], corners[1])}, ` +
      `${lengthText(stop.pass.altitude, section.unit)} up, ${plural(stop.pass.pictures, 'picture', 'pictures')}`),
    make('p', {}, section.causes[stop.cause].text)));
};

// Lines alone: outlines, passes, the way, where the pictures were.
const slatePlan = (section, stops) => {
  const box = wider(boxOf([...section.track.pictures.map((picture) => picture.center),
    ...stops.flatMap((stop) => [...stop.outline.flat(), ...stop.pass.corners])]), 0.05);
  const unit = Math.max(box.width / 718, box.height / 287);  // of the 190 x 76 mm, in 96ths of an inch
  const line = (corners, width, dashes) => draw('polyline', { points: lineOf(corners), fill: 'none', stroke: '#000',
    'stroke-width': width * unit, 'stroke-dasharray': dashes && dashes.map((d) => d * unit).join(' ') });
  const mark = (stop) => {
    const [x, y] = stopCorners(stop)[0];
    return draw('g', { transform: `translate(${x} ${-y}) scale(${unit})` },
      draw('circle', { r: 9, fill: '#fff', stroke: '#000', 'stroke-width': 1.5 }),
      draw('text', { y: 4.5, 'font-size': 12, 'font-weight': 700, 'text-anchor': 'middle' }, String(stop.number)));
  };
  const length = scaleLength(120 * unit);
  return draw('svg', { viewBox: `${box.x} ${box.y} ${box.width} ${box.height}`, role: 'img',
    'aria-label': `Plan of the first ${stops.length} stops` },
  line(section.track.pictures.map((picture) => picture.center), 0.5, [1, 3]),
  stops.map((stop) => draw('path', { d: pathOf(stop.outline), fill: '#bbb', 'fill-rule': 'evenodd', stroke: '#000', 'stroke-width': unit })),
  line(stops.flatMap(stopCorners), 2, [6, 3]), stops.map(mark),
  draw('g', { transform: `translate(${box.x + 8 * unit} ${box.y + box.height - 8 * unit}) scale(${unit})` },
    draw('path', { d: `M0 -5V0H${length / unit}V-5`, fill: 'none', stroke: '#000', 'stroke-width': 1.5 }),
    draw('text', { x: 4, y: -6, 'font-size': 11 }, lengthText(length, section.unit))),
  draw('g', { transform: `translate(${box.x + box.width - 14 * unit} ${box.y + 34 * unit}) scale(${unit})` },
    draw('path', { d: 'M0 0V-26M-5 -18L0 -28L5 -18', fill: 'none', stroke: '#000', 'stroke-width': 2 }),
    draw('text', { y: 12, 'font-size': 11, 'text-anchor': 'middle' }, section.is_north_up ? 'N' : 'up')));
};

const makeSlate = (section) => {
  const stops = slateStops(section);
  if (stops.length === 0) return null;
  const title = section.name ? `Slate, model ${section.name}` : 'Slate';
  const left = section.gaps.length - stops.length;
  return make('section', { class: 'slate', 'aria-label': title },
    make('div', { class: 'head' }, make('h2', {}, title),
      make('span', {}, `${plural(section.gaps.length, 'gap', 'gaps')}, way ${lengthText(section.figures.route_length, section.unit)}` +
        (left > 0 ? `; ${left} more on the page` : ''))),
    make('p', {}, section.is_north_up ? 'Headings from north.' : 'Headings from the plan\'s up (not north): turn the plan until landmarks fit.'),
    make('div', { class: 'plan' }, slatePlan(section, stops)),
    make('ol', { class: 'stops' }, stops.map((stop, k) =>
      stopEntry(section, stop, k > 0 && stopCorners(stops[k - 1]).at(-1)))));
};
