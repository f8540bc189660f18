// All that is told of one model.
const fact = (name, value, isShare) => make('div', { class: isShare && 'share' }, make('dt', {}, name), make('dd', {}, value));

const sectionFacts = (section) => {
  const { figures, unit, gaps } = section, [at] = figures.coverage;
  const missing = gaps.reduce((sum, gap) => sum + gap.area, 0);
  return make('dl', { class: 'facts' },
    fact('covered', `${percent(at.share)} ± ${(100 * figures.tolerance).toFixed(1)}`, true),
    fact('covered of what was asked for', `${digits(at.area)} of ${areaText(figures.expected_area, unit)}`),
    fact('at a spacing of', lengthText(at.spacing, unit)),
    fact('gaps to go back to', gaps.length === 0 ? 'none' : `${gaps.length}, ${areaText(missing, unit)}`),
    gaps.length > 0 && fact('route over all', lengthText(figures.route_length, unit)));
};

const missingTable = (section) => {
  const { figures, unit } = section;
  return table('What is missing, by cause (small gaps included)', ['why', { text: 'area', isNumber: true }, { text: 'share', isNumber: true }],
    figures.missing.map(({ cause, area }) => [make('span', {}, causeSwatch(section, cause), section.causes[cause].text),
      areaText(area, unit), percent(area / figures.expected_area)]));
};

const coverageTable = ({ figures, unit }) => table('Covered, at the wanted and at coarser spacings',
  [{ text: 'spacing', isNumber: true }, { text: 'covered', isNumber: true }, { text: 'share', isNumber: true }],
  figures.coverage.map(({ spacing, area, share }) => [lengthText(spacing, unit), areaText(area, unit), percent(share)]));

const qualityText = ({ figures, unit }) => `A pixel covers ${lengthText(figures.gsd, unit)}; ` +
  `${digits(figures.points_per_area)} points a ${unit === 'm' ? 'm²' : 'square unit'} of what is covered, ` +
  `seen by ${digits(figures.mean_views, 2)} pictures on average, with a parallax of ${digits(figures.parallax_deg, 2)}° in the middle. ` +
  `${areaText(figures.unlisted_area, unit)} are missing in spots too small to be listed.`;

const selfCheckText = ({ figures: { self_check: check }, unit }) => check === null
  ? 'The ± of the covered share is what another threshold would have said; no picture was hidden to measure it.'
  : `The ± of the covered share was measured: with a quarter of the pictures hidden at a time ${areaText(check.hidden_area, unit)} ` +
    `went; ${percent(check.found_share)} of what had to be missed was, and the missing area was said ${percent(check.area_error)} wrong.`;

const lostText = (run) => {
  const names = run.names.length > 4 ? `${run.names[0]} to ${run.names.at(-1)} (${run.names.length} pictures)` : run.names.join(', ');
  if (run.before && run.after) return `${names}: somewhere between ${run.before} and ${run.after}`;
  return `${names}: ${run.before ? 'after ' + run.before : run.after ? 'before ' + run.after : 'place unknown'}`;
};
const lostList = ({ lost }) => lost.length > 0 && [make('h3', {}, 'Pictures that are in no model'),
  make('ul', {}, lost.slice(0, 30).map((run) => make('li', {}, lostText(run)))),
  lost.length > 30 && make('p', {}, `and ${lost.length - 30} more stretches: completeness.json names them`)];

const otherLayers = ({ map }) => map.layers.length > 0 && [make('h3', {}, 'Walls and undersides'),
  make('p', { class: 'note' }, 'Surfaces steeper than 75 degrees, looked at from their side.'),
  map.layers.map(({ name, src }) => make('figure', {}, make('img', { src, alt: `Map of the side ${name}, coloured by cause`, style: 'max-width:100%' }),
    make('figcaption', {}, name)))];

// `choose` leads from a number on the map to the gap's entry.
const makeChooser = (section, content) => (gap) => {
  const id = `gap-${section.index}-${gap.id}`;
  if (!document.getElementById(id)) content.querySelector('ol.gaps')?.showAll?.();
  for (const chosen of content.querySelectorAll('.chosen')) chosen.classList.remove('chosen');
  const entry = document.getElementById(id);
  entry.classList.add('chosen');
  entry.scrollIntoView({ block: 'center' });
  entry.focus({ preventScroll: true });
};

const makeSection = (section) => {
  const content = make('section', { class: 'model has-slate', id: 'model-' + section.index,
    'aria-label': section.name ? 'Model ' + section.name : 'The survey' });
  const map = makeMap(section, makeChooser(section, content));
  const slate = makeSlate(section);
  const heading = section.name !== '';
  fill(content, {}, [
    make('h2', {}, heading ? `Model ${section.name}: ${percent(section.figures.coverage[0].share)} covered` : 'What is covered'),
    heading && make('p', {}, section.answer),
    sectionFacts(section), map.figure,
    make('h3', {}, section.gaps.length > 0 ? 'Where to go back to' : 'No gap to go back to'),
    section.gaps.length > 0 && make('p', { class: 'note' }, 'The most area for a way first. The map shows the route when asked to.'),
    slate && make('p', { class: 'tools' }, make('button', { type: 'button', class: 'main', onclick: () => printSlate(slate) }, 'Print the diver\'s slate (A4)')),
    section.gaps.length > 0 && makeGaps(section, map),
    make('h3', { class: 'on-screen' }, 'In three dimensions'), makeCloud(section),
    make('h3', {}, 'The track'), makeTrack(section), lostList(section), otherLayers(section),
    make('h3', {}, 'In figures'), coverageTable(section), missingTable(section), make('p', {}, qualityText(section)), make('p', {}, selfCheckText(section)),
    make('p', { class: 'note' }, `Coordinates: ${section.frame}.`), slate]);
  return content;
};
