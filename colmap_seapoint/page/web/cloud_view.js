// The cloud in three dimensions, with gaps, route and cameras, by three.js.
let threeModule = null;
const loadThree = () => {
  if (!threeModule) {
    const text = document.getElementById('three').textContent;
    const address = URL.createObjectURL(new Blob([text], { type: 'text/javascript' }));
    threeModule = import(address).finally(() => URL.revokeObjectURL(address));
  }
  return threeModule;
};

const routeObject = (three, corners, low) => {
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', new three.Float32BufferAttribute(
    corners.flatMap((p) => p.map((v, axis) => v - low[axis])), 3));
  return new three.Line(geometry, new three.LineBasicMaterial({ color: '#ffe600' }));
};

// All outlines as one object: a gap may be of a thousand pieces.
const outlinesObject = (three, section, low) => {
  const places = [], colors = [];
  for (const gap of section.gaps) {
    const color = new three.Color().setStyle(section.causes[gap.cause].color, three.LinearSRGBColorSpace).toArray();
    for (const ring of gap.outline) {
      ring.forEach((corner, k) => {
        for (const [x, y, z] of [corner, ring[(k + 1) % ring.length]]) {
          places.push(x - low[0], y - low[1], z - low[2]);
          colors.push(...color);
        }
      });
    }
  }
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', new three.Float32BufferAttribute(places, 3));
  geometry.setAttribute('color', new three.Float32BufferAttribute(colors, 3));
  return new three.LineSegments(geometry, new three.LineBasicMaterial({ vertexColors: true }));
};

// Four edges from each camera's centre, `size` long.
const camerasObject = (three, pictures, size, low) => {
  const corners = [];
  for (const { center, axis } of pictures) {
    const view = new three.Vector3(...axis);
    const side = new three.Vector3(1, 0, 0).cross(view);
    if (side.lengthSq() < 0.01) side.set(0, 1, 0).cross(view);
    side.normalize();
    const other = view.clone().cross(side);
    const from = new three.Vector3(...center.map((v, k) => v - low[k]));
    for (const [a, b] of [[1, 1], [1, -1], [-1, -1], [-1, 1]]) {
      const to = from.clone().addScaledVector(view, size)
        .addScaledVector(side, 0.5 * a * size).addScaledVector(other, 0.4 * b * size);
      corners.push(...from.toArray(), ...to.toArray());
    }
  }
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', new three.Float32BufferAttribute(corners, 3));
  return new three.LineSegments(geometry, new three.LineBasicMaterial({ color: '#9fd3ff' }));
};

const numberSprite = (three, text) => {
  const canvas = make('canvas', { width: 96, height: 96 });
  const context = canvas.getContext('2d');
  context.fillStyle = '#fff';
  context.beginPath();
  context.arc(48, 48, 44, 0, 7);
  context.fill();
  context.fillStyle = '#000';
  context.font = `bold ${text.length > 2 ? 40 : 52}px sans-serif`;
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillText(text, 48, 51);
  return new three.Sprite(new three.SpriteMaterial({ map: new three.CanvasTexture(canvas), depthTest: false,
    sizeAttenuation: false }));
};

const buildScene = (three, section, cloud, extent) => {
  const scene = new three.Scene();
  const geometry = new three.BufferGeometry();
  geometry.setAttribute('position', new three.BufferAttribute(cloud.places, 3));
  geometry.setAttribute('color', new three.BufferAttribute(cloud.colors, 3, true));
  const points = new three.Points(geometry, new three.PointsMaterial({ vertexColors: true, sizeAttenuation: true,
    size: 2.2 * extent.radius / Math.sqrt(section.cloud.count) }));
  const gaps = new three.Group(), numbers = new three.Group();
  for (const gap of [...section.gaps].sort((a, b) => b.area - a.area).slice(0, numberedGaps)) {
    const sprite = numberSprite(three, String(gap.id));
    sprite.position.set(...gap.middle.map((v, axis) => v - cloud.low[axis]));
    sprite.scale.setScalar(0.045);
    numbers.add(sprite);
  }
  gaps.add(outlinesObject(three, section, cloud.low), numbers);
  const cameras = camerasObject(three, section.track.pictures, 0.02 * extent.radius, cloud.low);
  const corners = routeCorners(section);
  const route = new three.Group();
  if (corners.length > 1) route.add(routeObject(three, corners, cloud.low));
  scene.add(points, gaps, cameras, route);
  return { scene, parts: { points, gaps, cameras, route } };
};

// A camera that turns about a middle; angles in radians, distance in radii.
const makeOrbit = (three, extent) => {
  const home = { turn: -0.5, rise: 0.9, distance: 2.4, middle: new three.Vector3(...extent.middle) };
  const orbit = { ...home, middle: home.middle.clone() };
  const camera = new three.PerspectiveCamera(40, 1, 0.01 * extent.radius, 40 * extent.radius);
  camera.up.set(0, 0, 1);
  const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
  return {
    camera,
    turn(dx, dy) { orbit.turn -= dx; orbit.rise = clamp(orbit.rise + dy, -1.5, 1.55); },
    zoom(factor) { orbit.distance = clamp(orbit.distance / factor, 0.05, 20); },
    slide(dx, dy) {
      const right = new three.Vector3().setFromMatrixColumn(camera.matrix, 0);
      const up = new three.Vector3().setFromMatrixColumn(camera.matrix, 1);
      const step = orbit.distance * extent.radius;
      orbit.middle.addScaledVector(right, -dx * step).addScaledVector(up, dy * step);
    },
    reset() { Object.assign(orbit, home, { middle: home.middle.clone() }); },
    place() {
      const flat = Math.cos(orbit.rise);
      camera.position.set(flat * Math.sin(orbit.turn), -flat * Math.cos(orbit.turn), Math.sin(orbit.rise))
        .multiplyScalar(orbit.distance * extent.radius).add(orbit.middle);
      camera.lookAt(orbit.middle);
      camera.updateMatrix();
    },
  };
};

const steerOrbit = (canvas, orbit, redraw) => {
  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  canvas.addEventListener('pointermove', (event) => {
    const finger = fingers.get(event.pointerId);
    if (!finger) return;
    const before = fingers.size === 2 ? spread() : 0;
    const dx = (event.clientX - finger.x) / canvas.clientHeight, dy = (event.clientY - finger.y) / canvas.clientHeight;
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (fingers.size === 2) {
      if (before > 0) orbit.zoom(spread() / before);
      orbit.slide(dx / 2, dy / 2);
    } else if (event.shiftKey || event.buttons === 2) orbit.slide(dx, dy);
    else orbit.turn(4 * dx, 4 * dy);
    redraw();
  });
  for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
  canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  canvas.addEventListener('wheel', (event) => {
    if (document.activeElement !== canvas && !event.ctrlKey) return;
    event.preventDefault();
    orbit.zoom(event.deltaY < 0 ? 1.2 : 1 / 1.2);
    redraw();
  }, { passive: false });
  canvas.addEventListener('keydown', (event) => {
    const acts = { ArrowLeft: () => orbit.turn(-0.1, 0), ArrowRight: () => orbit.turn(0.1, 0),
      ArrowUp: () => orbit.turn(0, 0.1), ArrowDown: () => orbit.turn(0, -0.1), '+': () => orbit.zoom(1.2),
      '=': () => orbit.zoom(1.2), '-': () => orbit.zoom(1 / 1.2), 0: () => orbit.reset() };
    if (!acts[event.key]) return;
    event.preventDefault();
    acts[event.key]();
    redraw();
  });
};

const startCloud = async (section, canvas, choices) => {
  const three = await loadThree();
  const cloud = unpackCloud(section.cloud), extent = extentOf(cloud.places);
  const { scene, parts } = buildScene(three, section, cloud, extent);
  const orbit = makeOrbit(three, extent);
  const renderer = new three.WebGLRenderer({ canvas, antialias: true });
  // Colours of the cloud are the pictures' own, and are shown as they are.
  renderer.outputColorSpace = three.LinearSRGBColorSpace;
  let isAsked = false;
  const redraw = () => {
    if (isAsked) return;
    isAsked = true;
    requestAnimationFrame(() => {
      isAsked = false;
      const width = canvas.clientWidth, height = canvas.clientHeight;
      if (!width || !height) return;
      renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
      renderer.setSize(width, height, false);
      orbit.camera.aspect = width / height;
      orbit.camera.updateProjectionMatrix();
      orbit.place();
      renderer.render(scene, orbit.camera);
      canvas.dataset.drawn = section.cloud.count;
    });
  };
  steerOrbit(canvas, orbit, redraw);
  choices.replaceChildren(...['points', 'gaps', 'cameras', 'route'].map((name) => make('label', {},
    make('input', { type: 'checkbox', checked: true, onchange: (event) => {
      parts[name].visible = event.target.checked;
      redraw();
    } }), name)), make('button', { type: 'button', onclick: () => { orbit.reset(); redraw(); } }, 'Show all'));
  new ResizeObserver(redraw).observe(canvas);
  redraw();
};

// A browser may need a second to begin with 3D, and shows nothing else meanwhile: the map comes first.
const afterFirstPaint = new Promise((resolve) => requestAnimationFrame(() =>
  requestAnimationFrame(() => setTimeout(resolve, 60))));

const makeCloud = (section) => {
  if (!section.cloud || section.cloud.count === 0) {
    return make('p', { class: 'note' }, section.cloud ? 'There is no cloud to show.' :
      'The page would be too large with this model\'s cloud; the model\'s own page in completeness/ shows it.');
  }
  const canvas = make('canvas', { tabindex: '0', role: 'img',
    'aria-label': `The cloud from the side, ${section.cloud.count} of its points, with gaps, cameras and the route` });
  const choices = make('div', { class: 'choices' }), note = make('p', { class: 'note' });
  const fail = (error) => note.replaceChildren('This browser does not draw the 3D view: ' + error.message);
  const watch = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watch.disconnect();
    afterFirstPaint.then(() => startCloud(section, canvas, choices)).catch(fail);
  }, { rootMargin: '1500px' });
  watch.observe(canvas);
  return make('figure', { class: 'cloud' }, choices, canvas, note, make('figcaption', {},
    `${section.cloud.count} points of the cloud. Drag or arrow keys turn, with Shift or two fingers they shift; + and − zoom, 0 shows all.`));
};
