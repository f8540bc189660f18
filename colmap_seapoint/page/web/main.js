// Puts the page together. A map is on the screen before the next model is begun.
const root = document.documentElement;

const printSlate = (slate) => {
  for (const other of document.querySelectorAll('.slate')) other.classList.toggle('wanted', other === slate);
  for (const section of document.querySelectorAll('.model')) section.classList.toggle('has-slate', section.contains(slate));
  root.classList.add('slate-only');
  window.print();
};
const leaveSlate = () => {
  if (location.hash !== '#slate') root.classList.remove('slate-only');
};
window.addEventListener('afterprint', leaveSlate);

const contrast = document.getElementById('contrast');
contrast.addEventListener('click', () => {
  const isDeck = root.classList.toggle('deck');
  contrast.setAttribute('aria-pressed', String(isDeck));
});
document.getElementById('print').addEventListener('click', () => window.print());

const main = document.getElementById('main');
const names = readJson(document.getElementById('names'));
const texts = [...document.querySelectorAll('script.section')];
if (texts.length > 1) {
  main.append(make('nav', { 'aria-label': 'Models' }, make('ul', {}, texts.map((text, index) =>
    make('li', {}, make('a', { href: '#model-' + index }, 'Model ' + names[index]))))));
}
texts.forEach((text, index) => {
  const section = { ...readJson(text), index, name: texts.length > 1 ? names[index] : '' };
  main.append(makeSection(section));
  text.remove();
});
const job = readJson(document.getElementById('job'));
if (job) main.append(makeJob(job));

// index.html#slate is the slate alone, for printing without a hand.
if (location.hash === '#slate') {
  const slate = document.querySelector('.slate');
  if (slate) {
    slate.classList.add('wanted');
    for (const section of document.querySelectorAll('.model')) section.classList.toggle('has-slate', section.contains(slate));
    root.classList.add('slate-only');
  }
}
