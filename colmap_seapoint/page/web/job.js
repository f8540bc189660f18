// The run: what was used, what was left out and why, how long it took.
const leftOutList = (leftOut) => leftOut.length > 0 ? table('Left out', ['what', 'why'], leftOut.map(({ name, reason }) => [name, reason])) :
  make('p', {}, 'Nothing was left out.');

const stageTable = (stages) => table('Stages', ['stage', { text: 'time', isNumber: true }, { text: 'of all processors', isNumber: true }],
  stages.map((stage) => [stage.name, secondsText(stage.wall_seconds), secondsText(stage.cpu_seconds)]));

const makeJob = (job) => make('section', { 'aria-label': 'The run' },
  make('h2', {}, 'The run'),
  make('p', {}, `${job.command} ${job.version}: ${job.images_used} of ${plural(job.images_in, 'picture', 'pictures')} used, ${job.points} points.`),
  job.cameras && job.cameras.length > 0 && make('ul', {}, job.cameras.map((camera) => make('li', {}, camera))),
  make('h3', {}, 'Left out, and why'), leftOutList(job.left_out),
  job.stages.length > 0 && [make('h3', {}, 'How long it took'), stageTable(job.stages)]);
