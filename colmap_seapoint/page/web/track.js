// The track, picture by picture: what each shares with the next one, and what of it was covered.
const chartBars = 400;  // more would be thinner than a pixel; then the worst of neighbours is shown

const worstOf = (pictures, count) => {
  const step = Math.ceil(pictures.length / count), bars = [];
  for (let k = 0; k < pictures.length; k += step) {
    const some = pictures.slice(k, k + step).map((picture, n) => ({ ...picture, at: k + n }));
    bars.push(some.reduce((a, b) => (b.overlap >= 0 && (a.overlap < 0 || b.overlap < a.overlap) ? b : a)));
  }
  return bars;
};

const trackChart = (pictures) => {
  const width = window.innerWidth < 600 ? 420 : 1000, height = 190, left = 44, bottom = 30, top = 10;
  const bars = worstOf(pictures, chartBars), step = (width - left) / bars.length;
  const y = (share) => top + (1 - share) * (height - top - bottom);
  const bar = (picture, k) => picture.overlap < 0 ? null : draw('rect', { x: left + k * step, y: y(picture.overlap),
    width: Math.max(0.8, step - (step > 4 ? 1 : 0)), height: y(0) - y(picture.overlap),
    fill: picture.overlap < 0.5 ? '#d55e00' : '#0072b2' },
  draw('title', {}, `${picture.name}: ${percent(picture.overlap, 0)} of it is in the next picture, ${percent(picture.covered, 0)} is covered`));
  const bad = (picture, k) => picture.is_bad && draw('text', { x: left + (k + 0.5) * step, y: y(0) + 12, 'text-anchor': 'middle' }, '×');
  const few = pictures.filter((picture) => picture.overlap >= 0 && picture.overlap < 0.5).length;
  return draw('svg', { class: 'chart', viewBox: `0 0 ${width} ${height}`, role: 'img',
    'aria-label': `Overlap with the next picture, of ${plural(pictures.length, 'picture', 'pictures')}: below one half for ${few}` },
  [0, 0.5, 1].map((share) => [draw('path', { d: `M${left} ${y(share)}H${width}`, stroke: 'currentColor', 'stroke-width': 0.6 }),
    draw('text', { x: left - 4, y: y(share) + 4, 'text-anchor': 'end' }, percent(share, 0))]),
  bars.map(bar), bars.map(bad),
  draw('text', { x: left, y: height - 3 }, shortName(pictures[0].name)),
  draw('text', { x: width - 2, y: height - 3, 'text-anchor': 'end' }, shortName(pictures[pictures.length - 1].name)));
};

const hintList = (track) => {
  if (track.hints.length === 0) return make('p', {}, 'Nothing to do otherwise: overlap, height and light stayed near their usual values.');
  const name = (k) => track.pictures[k].name;
  return make('ul', {}, track.hints.map((hint) => make('li', {},
    (hint.first === hint.last ? name(hint.first) : `${name(hint.first)} to ${name(hint.last)}`) + ': ' + hint.text)));
};

const pairRows = (pairs) => pairs.map(([first, second, overlap, points, skipped]) =>
  [first, second, percent(overlap, 0), String(points), skipped]);

const makeTrack = (section) => {
  const { track } = section;
  if (track.pictures.length === 0) return make('p', {}, 'The model holds no pictures.');
  const pairs = track.pairs.length > 0 && make('details', { ontoggle: (event) => {
    if (!event.target.open || event.target.querySelector('table')) return;
    event.target.append(table('Pairs in the order in which they were densified', ['picture', 'with',
      { text: 'overlap with what came before', isNumber: true }, { text: 'points', isNumber: true }, 'why it was passed over'],
    pairRows(track.pairs)));
  } }, make('summary', {}, plural(track.pairs.length, 'pair', 'pairs') + ' that were tried'));
  return make('div', {}, make('figure', {}, trackChart(track.pictures), make('figcaption', {},
    'How much of each picture the next one shows, by the model\'s points; orange and below the middle line: a place may be in one picture alone. × : blurred or badly exposed.')),
  make('h3', {}, 'On the next dive'), hintList(track), pairs);
};
