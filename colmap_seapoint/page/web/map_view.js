// What of the plan a map shows: zoom and shift. SVG's y is the plan's, turned over.
const makeView = (svg, box, onChange) => {
  const whole = { ...box };
  let shown = { ...box };
  const apply = () => {
    svg.setAttribute('viewBox', `${shown.x} ${shown.y} ${shown.width} ${shown.height}`);
    onChange(view);
  };
  const clamp = () => {
    shown.width = Math.min(Math.max(shown.width, whole.width / 60), whole.width);
    shown.height = shown.width * whole.height / whole.width;
    shown.x = Math.min(Math.max(shown.x, whole.x), whole.x + whole.width - shown.width);
    shown.y = Math.min(Math.max(shown.y, whole.y), whole.y + whole.height - shown.height);
  };
  // Plan units a pixel of the screen, as preserveAspectRatio has it.
  const unitsPerPixel = () => {
    const rect = svg.getBoundingClientRect();
    if (!rect.width || !rect.height) return whole.width / 700;
    return Math.max(shown.width / rect.width, shown.height / rect.height);
  };
  const placeAt = (event) => {
    const point = new DOMPoint(event.clientX, event.clientY);
    return point.matrixTransform(svg.getScreenCTM().inverse());
  };
  const view = {
    unitsPerPixel,
    isWhole: () => shown.width > 0.999 * whole.width,
    zoom(factor, about) {
      const at = about || { x: shown.x + shown.width / 2, y: shown.y + shown.height / 2 };
      const width = Math.min(Math.max(shown.width / factor, whole.width / 60), whole.width);
      const ratio = width / shown.width;
      shown = { x: at.x - (at.x - shown.x) * ratio, y: at.y - (at.y - shown.y) * ratio,
        width, height: shown.height * ratio };
      clamp();
      apply();
    },
    shift(dx, dy) {
      shown.x += dx;
      shown.y += dy;
      clamp();
      apply();
    },
    step(dx, dy) { view.shift(dx * shown.width / 6, dy * shown.height / 6); },
    reset() { shown = { ...whole }; apply(); },
    // Another box is all that there is to see.
    frame(other) {
      Object.assign(whole, other);
      svg.style.aspectRatio = `${whole.width} / ${whole.height}`;
      view.reset();
    },
    // A box with as much again around it.
    show(target) {
      const side = Math.max(2.5 * target.width, 2.5 * target.height * whole.width / whole.height, whole.width / 12);
      shown = { x: target.x + target.width / 2 - side / 2, width: side,
        y: target.y + target.height / 2 - side * whole.height / whole.width / 2, height: 1 };
      clamp();
      apply();
    },
    refresh: apply,
  };
  listenToPointers(svg, view, placeAt, unitsPerPixel);
  return view;
};

// Dragging, two fingers, and the wheel with Ctrl (without it the page scrolls, as a reader expects).
const listenToPointers = (svg, view, placeAt, unitsPerPixel) => {
  const fingers = new Map();
  const distance = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  svg.addEventListener('pointerdown', (event) => {
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  svg.addEventListener('pointermove', (event) => {
    const finger = fingers.get(event.pointerId);
    if (!finger) return;
    const before = fingers.size === 2 ? distance() : 0;
    const dx = event.clientX - finger.x, dy = event.clientY - finger.y;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (fingers.size === 2 && before > 0) view.zoom(distance() / before, placeAt(event));
    else if (!view.isWhole()) view.shift(-dx * unitsPerPixel(), -dy * unitsPerPixel());
  });
  const lift = (event) => fingers.delete(event.pointerId);
  for (const name of ['pointerup', 'pointercancel', 'pointerleave']) svg.addEventListener(name, lift);
  svg.addEventListener('wheel', (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    view.zoom(event.deltaY < 0 ? 1.3 : 1 / 1.3, placeAt(event));
  }, { passive: false });
  svg.addEventListener('dblclick', (event) => view.zoom(2, placeAt(event)));
};
