// The camera, which each person has for themselves, and the robot, which is seen from far too.
"use strict";

(() => {
  const { own, drawing } = window.hectorscope;
  const MAP = "/floor/map/";
  const GRID = "/floor/grid/lines";
  const ROBOT = "/robot";
  const MAGNIFIED = ["/robot/hull", "/floor/footprint", "/frames/base_footprint", "/frames/base_stabilized", "/frames/base_link"];
  const ROBOT_LENGTH = 0.66; // metres
  const ROBOT_PIXELS = 26;
  const RIMS = ["prior", "match", "fused"].map((key) => `/floor/${key}/pose/rim`);
  const MARGIN = 1.08; // the map fills this much less than the window
  const SMOOTH = 0.25; // seconds of lag of every movement, but for who wants less motion
  const LESS_MOTION = window.matchMedia("(prefers-reduced-motion: reduce)");
  const TILT = 0.97; // radians off the vertical
  const NEAR = 18; // metres: following begins no farther than this
  const KEPT = 1000; // milliseconds between two looks at what to keep of the camera

  const viser = () => window.__viserMutable;

  const meshesBelow = (root) =>
    Object.entries(viser()?.nodeRefFromName ?? {})
      .filter(([name, node]) => name.startsWith(root) && node)
      .flatMap(([, node]) => {
        const found = [];
        node.traverse((child) => child.isMesh && found.push(child));
        return found;
      });
  // ------------------------------------------------------------------------------------- seen from far away

  // The robot and its frames are never smaller than can be seen.
  function magnify(page) {
    const robot = page.nodeRefFromName[ROBOT];
    if (!robot) return;
    const reach = size(minus(page.camera.position, column(robot.matrixWorld, 3)));
    const metresPerPixel = (2 * reach * Math.tan((page.camera.fov * Math.PI) / 360)) / window.hectorscope.size.height;
    const scale = Math.max(1, (ROBOT_PIXELS * metresPerPixel) / ROBOT_LENGTH);
    for (const name of MAGNIFIED) page.nodeRefFromName[name]?.scale.setScalar(scale);
  }

  // ------------------------------------------------------------------------------------------------ camera

  // auto: keep the whole map in view until somebody touches the camera. goal: the polar angle on the way to, with north up.
  // moved: when anything here moved the camera last; still: frames since then.
  const state = { auto: true, follow: false, top: false, goal: null, distance: null, last: null, pan: null, moved: 0, still: 0 };

  function moving() {
    state.moved = performance.now();
    state.still = 0;
  }

  const minus = (a, b) => ({ x: a.x - b.x, y: a.y - b.y, z: a.z - b.z });
  const plus = (a, b) => ({ x: a.x + b.x, y: a.y + b.y, z: a.z + b.z });
  const times = (a, k) => ({ x: a.x * k, y: a.y * k, z: a.z * k });
  const dot = (a, b) => a.x * b.x + a.y * b.y + a.z * b.z;
  const size = (a) => Math.sqrt(dot(a, a));
  const column = (matrix, i) => ({ x: matrix.elements[4 * i], y: matrix.elements[4 * i + 1], z: matrix.elements[4 * i + 2] });

  function corners() {
    const found = [];
    const floor = viser().nodeRefFromName["/floor"];
    const { box, places, beside } = window.hectorscope.levels();
    if (!floor) return found;
    const [right, up, over, at] = [0, 1, 2, 3].map((i) => column(floor.matrixWorld, i));
    const point = (x, y, z) => plus(at, plus(times(right, x), plus(times(up, y), times(over, z))));
    for (const { x, y, z, shown } of [...places, ...beside]) {
      if (!shown) continue;
      for (const i of [-0.5, 0.5])
        for (const j of [-0.5, 0.5]) found.push(point(box.x + x + i * box.width, box.y + y + j * box.height, z));
    }
    return found;
  }

  // Where to look, and from how far, to have all of the map in view: exact for a given direction.
  function fitted(camera) {
    const points = corners();
    if (!points.length) return null;
    const axes = ["x", "y", "z"];
    const centre = {};
    for (const k of axes) {
      const values = points.map((p) => p[k]);
      centre[k] = (Math.min(...values) + Math.max(...values)) / 2;
    }
    const [right, up, back] = [0, 1, 2].map((i) => column(camera.matrixWorld, i));
    const tall = Math.tan((camera.fov * Math.PI) / 360);
    const wide = tall * camera.aspect;
    let distance = 2;
    for (const point of points) {
      const v = minus(point, centre);
      const lean = dot(v, back);
      distance = Math.max(distance, lean + (MARGIN * Math.abs(dot(v, right))) / wide, lean + (MARGIN * Math.abs(dot(v, up))) / tall);
    }
    return { centre, distance };
  }

  // The turn about the vertical that puts the map's y axis upwards.
  function northUp() {
    const floor = viser()?.nodeRefFromName?.["/floor"];
    if (!floor) return 0;
    const north = column(floor.matrixWorld, 1);
    return Math.atan2(-north.x, -north.z);
  }

  const nearest = (angle, to) => angle + 2 * Math.PI * Math.round((to - angle) / (2 * Math.PI));

  function turn(controls, share) {
    if (state.goal === null) return;
    const azimuth = nearest(northUp(), controls.azimuthAngle);
    const [a, p] = [azimuth - controls.azimuthAngle, state.goal - controls.polarAngle];
    const done = Math.abs(a) + Math.abs(p) < 0.002;
    const k = done ? 1 : share;
    moving();
    controls.rotateTo(controls.azimuthAngle + k * a, controls.polarAngle + k * p, false);
    if (done) state.goal = null;
  }

  function dolly(controls, goal, share) {
    const gap = goal - controls.distance;
    if (Math.abs(gap) < 0.002 * goal) return;
    moving();
    controls.dollyTo(controls.distance + share * gap, false);
  }

  function move(controls, goal, share) {
    const at = controls.getTarget();
    const gap = minus(goal, at);
    if (size(gap) < 1e-3) return;
    moving();
    const to = plus(at, times(gap, share));
    controls.moveTo(to.x, to.y, to.z, false);
  }

  function keepInView(controls, camera, share) {
    const goal = fitted(camera);
    if (!goal) return;
    move(controls, goal.centre, share);
    dolly(controls, goal.distance, share);
  }

  // The target moves with the robot; whatever the person adds by hand (pan, zoom, turn) stays.
  function chase(controls, share) {
    const robot = viser().nodeRefFromName[ROBOT];
    if (!robot) return;
    const at = controls.getTarget();
    if (state.last) state.pan = plus(state.pan, minus(at, state.last));
    const goal = plus(column(robot.matrixWorld, 3), state.pan);
    if (state.distance !== null) {
      dolly(controls, state.distance, share);
      if (Math.abs(controls.distance - state.distance) < 0.01 * state.distance) state.distance = null;
    }
    move(controls, goal, share);
    state.last = controls.getTarget();
  }

  function setHands(controls, top) {
    // From above, dragging moves the map; else it turns the view.
    const [drag, other] = [controls.mouseButtons.left, controls.mouseButtons.right];
    if (top !== state.top) {
      controls.mouseButtons.left = other;
      controls.mouseButtons.right = drag;
    }
    controls.maxPolarAngle = top ? Math.max(0, controls.polarAngle) : Math.PI;
  }

  function camera(mode) {
    const controls = viser()?.cameraControl;
    if (!controls || !["free", "follow", "top", "fit"].includes(mode)) return;
    if (mode === "top" || mode === "free") {
      setHands(controls, mode === "top");
      state.goal = mode === "top" ? 0 : state.top ? TILT : null;
      state.top = mode === "top";
    }
    state.auto = mode === "fit" || mode === "top";
    state.follow = mode === "follow";
    state.distance = state.follow && controls.distance > NEAR ? NEAR : null;
    state.last = null;
    state.pan = { x: 0, y: 0, z: 0 };
    moving();
  }

  function touched(event) {
    if (event.type === "pointermove" && event.buttons === 0) return;
    state.auto = false;
    state.goal = null;
    state.distance = null;
  }

  function watch(canvas) {
    if (canvas.dataset.hectorscope) return;
    canvas.dataset.hectorscope = "watched";
    for (const kind of ["wheel", "pointermove"]) canvas.addEventListener(kind, touched, { passive: true });
  }

  // Lowest first: the finest level, the metre grid, the levels above it, and then all that is drawn on the map.
  function order() {
    const { places } = window.hectorscope.levels();
    places.forEach(({ z }, index) => meshesBelow(`${MAP}level${index}/`).forEach((mesh) => (mesh.renderOrder = z > 0 ? -1 : -3)));
    viser().nodeRefFromName[GRID]?.traverse((child) => (child.renderOrder = -2));
    // A good match has an ellipse smaller than the robot: its rim shines through.
    for (const rim of RIMS.flatMap(meshesBelow)) {
      rim.renderOrder = 1;
      Object.assign(rim.material, { transparent: true, depthTest: false });
    }
  }

  let before = performance.now();

  function frame(now) {
    requestAnimationFrame(frame);
    const share = LESS_MOTION.matches ? 1 : 1 - Math.exp(-Math.min(now - before, 200) / 1000 / SMOOTH);
    before = now;
    const page = viser();
    if (!page?.cameraControl || !page.camera || !page.canvas) return;
    watch(page.canvas);
    state.still += 1;
    restore(page.cameraControl);
    turn(page.cameraControl, share);
    if (state.auto) keepInView(page.cameraControl, page.camera, share);
    if (state.follow) chase(page.cameraControl, share);
    if (state.top && state.goal === null) page.cameraControl.maxPolarAngle = 0;
  }

  // --------------------------------------------------------------------------------------------- kept

  const pose = (controls) => [controls.getPosition(), controls.getTarget()].flatMap(({ x, y, z }) => [x, y, z].map((value) => +value.toFixed(3)));

  // What this browser looked at last time: the way to look at it, and from where, unless that follows the map.
  let restored = false;
  function restore(controls) {
    if (restored || !window.hectorscope.levels().places.length) return;
    restored = true;
    const kept = own.get("camera");
    if (!kept) {
      if (own.get("layout") === "side") camera("top");
      return;
    }
    if (kept.top) camera("top");
    Object.assign(state, { auto: kept.auto === true });
    if (!state.auto) controls.setLookAt(...kept.pose, false);
    if (kept.follow === true) {
      camera("follow");
      state.distance = null;
    }
  }

  const cameraNow = () => ({ auto: state.auto, follow: state.follow, top: state.top, pose: pose(viser().cameraControl) });

  function keep() {
    const controls = viser()?.cameraControl;
    if (!restored || !controls || state.goal !== null) return;
    const now = cameraNow();
    const before = own.get("camera");
    const still = before && ["auto", "follow", "top"].every((key) => before[key] === now[key]);
    if (!still || (!now.auto && !now.follow && String(before.pose) !== String(now.pose))) own.set("camera", now);
  }
  setInterval(keep, KEPT);
  addEventListener("pagehide", keep);
  own.listen((key, value) => key === "layout" && value === "side" && camera("top")); // where it is largest
  document.addEventListener("click", ({ target }) => target.dataset?.hsCamera && camera(target.dataset.hsCamera));

  drawing.push((page) => {
    magnify(page);
    order();
  });
  Object.assign(window.hectorscope, { camera, cameraNow, lessMotion: () => LESS_MOTION.matches, restoreCamera: () => (restored = false), cameraState: () => ({ ...state }) });
  requestAnimationFrame(frame);
})();
