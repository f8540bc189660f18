// A cause has a colour and, for prints without colour and for eyes that see few, a hatching.
const hatchings = {
  never_imaged: 'M0 0L8 8M8 0L0 8', imaged_once: 'M0 4H8', no_texture: '',
  bad_picture: 'M4 0V8', pose_lost: 'M0 8L8 0', occluded: 'M0 0L8 8', small_parallax: 'M4 0V8M0 4H8',
  views_disagree: 'M2 2h.1M6 6h.1',
};
const patternId = (sectionIndex, cause) => 'cause-' + sectionIndex + '-' + cause;

// `unit`: how much of the map 8 pixels of the screen are.
const causePatterns = (section, unit) =>
  draw('defs', {}, Object.entries(section.causes).map(([cause, { color }]) =>
    draw('pattern', { id: patternId(section.index, cause), width: 8, height: 8,
      patternUnits: 'userSpaceOnUse', patternTransform: `scale(${unit / 8})` },
      draw('rect', { width: 8, height: 8, fill: color }),
      draw('path', { d: hatchings[cause] || '', stroke: '#000', 'stroke-width': 1, 'stroke-linecap': 'round' }))));

const causeSwatch = (section, cause) => {
  const { color } = section.causes[cause];
  return make('span', { class: 'swatch', 'aria-hidden': 'true',
    style: `background:${color}` });
};

const causeLegend = (section) => {
  const present = section.figures.missing.map((entry) => entry.cause);
  return make('ul', { class: 'legend', 'aria-label': 'Causes' }, present.map((cause) =>
    make('li', {}, causeSwatch(section, cause), section.causes[cause].text)));
};
