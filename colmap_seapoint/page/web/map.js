// The ground from above: a picture of it, and over it the gaps with their numbers.
const numberedGaps = 40;

const pathOf = (rings) => rings.map((ring) =>
  'M' + ring.map(([x, y]) => `${x} ${-y}`).join('L') + 'Z').join('');
const lineOf = (corners) => corners.map(([x, y]) => `${x},${-y}`).join(' ');

const boxOf = (places) => {
  const xs = places.map(([x]) => x), ys = places.map(([, y]) => -y);
  const low = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
  const high = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity);
  const x = low(xs), y = low(ys);
  return { x, y, width: high(xs) - x, height: high(ys) - y };
};
const wider = (box, share) => {
  const margin = share * Math.max(box.width, box.height);
  return { x: box.x - margin, y: box.y - margin, width: box.width + 2 * margin, height: box.height + 2 * margin };
};
// Passes reach beyond what is to be covered: they count when the route is shown.
const mapBox = ({ map, gaps, track }, withRoute) => {
  const corners = map.list.length > 0 ? [[map.left, map.top], [map.right, map.bottom]] :
    track.pictures.map((picture) => picture.center);
  const passes = withRoute ? gaps.flatMap((gap) => gap.pass.corners) : [];
  return wider(boxOf([...corners, ...passes, ...gaps.flatMap((gap) => gap.outline.flat())]), 0.03);
};

// Corners of the passes, in the order in which they are swum.
const routeCorners = (section) => section.route.flatMap((stop) => {
  const { corners } = section.gaps[stop.gap].pass;
  return stop.is_reversed ? [...corners].reverse() : corners;
});

const mosaicImage = ({ mosaic }) => {
  if (!mosaic) return null;
  const [a, b, c, d, e, f] = mosaic.plan_from_pixel;
  return draw('image', { href: mosaic.src, width: mosaic.width, height: mosaic.height,
    transform: `matrix(${a} ${-b} ${c} ${-d} ${e} ${-f})` });
};
const cellsImage = (map, entry) => draw('image', { class: 'cells', href: entry.src, x: map.left, y: -map.top,
  width: map.right - map.left, height: map.top - map.bottom, preserveAspectRatio: 'none' });

// Pictures to choose from; the mosaic first where there is one.
const groundsOf = (section) => {
  const { map } = section;
  const grounds = map.list.map((entry) => ({ key: entry.key, title: entry.title, note: entry.note,
    legend: entry.legend, images: () => [cellsImage(map, entry)] }));
  const relief = map.list.find((entry) => entry.key === 'relief');
  if (map.mosaic) {
    grounds.unshift({ key: 'mosaic', title: 'Orthomosaic', note: 'The pictures, seen from above.',
      legend: [], images: () => [mosaicImage(map)] });
  } else if (relief) {
    grounds.unshift(grounds.splice(grounds.findIndex((ground) => ground.key === 'relief'), 1)[0]);
  }
  return grounds;
};

const gapName = (section, gap) => `Gap ${gap.id}: ${section.causes[gap.cause].text}, ` +
  areaText(gap.area, section.unit);

const gapShape = (section, gap) => draw('path', { class: 'outline', d: pathOf(gap.outline),
  fill: `url(#${patternId(section.index, gap.cause)})`, 'fill-rule': 'evenodd' });

const gapMark = (section, gap, choose) => {
  const mark = draw('g', { class: 'mark', role: 'button', tabindex: '0', 'aria-label': gapName(section, gap),
    onclick: () => choose(gap), onkeydown: (event) => {
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      event.stopPropagation();
      choose(gap);
    } }, draw('title', {}, gapName(section, gap)), draw('circle', { r: 11 }),
  draw('text', { y: 4.5, 'font-size': gap.id > 99 ? 10 : 13 }, String(gap.id)));
  mark.place = { x: gap.middle[0], y: -gap.middle[1] };
  return mark;
};

const scaleLength = (width) => {
  const decade = 10 ** Math.floor(Math.log10(width));
  return [5, 2, 1].map((factor) => factor * decade).find((length) => length <= width);
};

// Marks and the scale bar keep their size on the screen; they are in pixels of it.
const placeMarks = (svg, marks, view) => {
  const unit = view.unitsPerPixel();
  for (const mark of marks) mark.setAttribute('transform', `translate(${mark.place.x} ${mark.place.y}) scale(${unit})`);
  for (const pattern of svg.querySelectorAll('pattern')) pattern.setAttribute('patternTransform', `scale(${unit})`);
  for (const camera of svg.querySelectorAll('.camera')) camera.setAttribute('r', 2.2 * unit);
};

const moveByKeys = (view) => (event) => {
  const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  if (steps[event.key]) view.step(...steps[event.key]);
  else if (event.key === '+' || event.key === '=') view.zoom(1.5);
  else if (event.key === '-') view.zoom(1 / 1.5);
  else if (event.key === '0') view.reset();
  else return;
  event.preventDefault();
};

const layerGroups = (section, choose) => {
  const corners = routeCorners(section);
  const { pictures } = section.track;
  return {
    gaps: draw('g', {}, section.gaps.map((gap) => gapShape(section, gap))),
    route: draw('g', { display: 'none' }, corners.length > 0 && [
      draw('polyline', { class: 'route', points: lineOf(corners) }),
      draw('polyline', { class: 'route inner', points: lineOf(corners) })]),
    track: draw('g', { display: 'none' },
      draw('polyline', { class: 'track', points: lineOf(pictures.map((picture) => picture.center)) }),
      pictures.map(({ center, name }) => draw('circle', { class: 'camera', cx: center[0], cy: -center[1] },
        draw('title', {}, name)))),
    numbers: draw('g', {}, [...section.gaps].sort((a, b) => a.area - b.area).slice(-numberedGaps)
      .map((gap) => gapMark(section, gap, choose))),
  };
};

const checkBox = (text, group, isOn, act) => make('label', {},
  make('input', { type: 'checkbox', checked: isOn, onchange: (event) => {
    group.setAttribute('display', event.target.checked ? 'inline' : 'none');
    if (act) act(event.target.checked);
  } }), text);

const viewButtons = (view) => make('div', { class: 'buttons', role: 'group', 'aria-label': 'Zoom' },
  [['+', 'Zoom in', () => view.zoom(1.6)], ['−', 'Zoom out', () => view.zoom(1 / 1.6)],
    ['⤢', 'Show all', () => view.reset()]].map(([text, label, act]) =>
    make('button', { type: 'button', 'aria-label': label, title: label, onclick: act }, text)));

const mapText = (section) => {
  const up = section.is_north_up ? 'North is up.' : 'What is up on the map is ahead in the model, not north.';
  return `${up} Drag, +, − and arrow keys move the map; Ctrl and the wheel zoom. A number leads to the gap's entry.`;
};

const makeMap = (section, choose) => {
  const box = mapBox(section, false);
  const ground = draw('g', {}), groups = layerGroups(section, choose);
  const svg = draw('svg', { viewBox: `${box.x} ${box.y} ${box.width} ${box.height}`, role: 'group', tabindex: '0',
    'aria-label': `Map of the survey with ${plural(section.gaps.length, 'gap', 'gaps')}` },
  causePatterns(section, box.width / 700), ground, groups.gaps, groups.route, groups.track, groups.numbers);
  const marks = [...groups.numbers.children], scale = make('p', { class: 'note' });
  const frame = make('div', { class: 'map' }, svg);
  svg.style.aspectRatio = `${box.width} / ${box.height}`;
  const view = makeView(svg, box, (changed) => {
    placeMarks(svg, marks, changed);
    frame.classList.toggle('near', !changed.isWhole());
    const length = scaleLength(160 * changed.unitsPerPixel());
    scale.replaceChildren(scaleBar(length / changed.unitsPerPixel()), ' ' + lengthText(length, section.unit));
  });
  frame.append(viewButtons(view));
  svg.addEventListener('keydown', moveByKeys(view));
  window.addEventListener('resize', () => view.refresh());
  const legend = make('div', {}), grounds = groundsOf(section);
  const show = (key) => {
    const chosen = grounds.find((entry) => entry.key === key);
    ground.replaceChildren(...chosen.images());
    groups.gaps.classList.toggle('plain', key === 'causes' || key === 'coverage');
    legend.replaceChildren(make('p', { class: 'note' }, chosen.note), groundLegend(chosen));
  };
  if (grounds.length > 0) show(grounds[0].key);
  requestAnimationFrame(() => view.refresh());
  return { view, marks, figure: make('figure', {}, mapChoices(section, grounds, show, groups, view), frame, scale, legend,
    causeLegend(section), make('figcaption', {}, mapText(section))) };
};

const scaleBar = (pixels) => draw('svg', { width: pixels + 2, height: 10, 'aria-hidden': 'true' },
  draw('path', { d: `M1 1V9M1 5H${pixels}M${pixels} 1V9`, stroke: 'currentColor', 'stroke-width': 2, fill: 'none' }));

const groundLegend = (ground) => make('ul', { class: 'legend', 'aria-label': ground.title },
  ground.legend.map(([color, text]) => make('li', {},
    make('span', { class: 'swatch', 'aria-hidden': 'true', style: `background:${color}` }), text)));

const mapChoices = (section, grounds, show, groups, view) => {
  const id = 'ground-' + section.index;
  return make('div', { class: 'choices' },
    make('label', { for: id }, 'Show '),
    make('select', { id, onchange: (event) => show(event.target.value) },
      grounds.map((ground) => make('option', { value: ground.key }, ground.title))),
    checkBox('gaps', groups.gaps, true), checkBox('numbers', groups.numbers, true),
    checkBox('route', groups.route, false, (isOn) => view.frame(mapBox(section, isOn))), checkBox('pictures', groups.track, false));
};
