// While a jump to another time is under way the scene is not drawn: it would be the old map, or the robot of one time on
// the map of another, and where drawing is slow, each would hold up the picture that is waited for.
"use strict";

(() => {
  const { drawing } = window.hectorscope;
  const CELLS = "/floor/map/level0/cells";
  const LONGEST = 500; // milliseconds; a run that takes longer to get there is shown on its way
  const BEHIND = 150; // milliseconds that a picture of the map may come behind all else; the same map brings none
  const page = () => window.__viserMutable;
  let jump = null;

  function picture() {
    let found = null;
    page()?.nodeRefFromName?.[CELLS]?.traverse((part) => (found ??= part.material?.map ?? null));
    return found;
  }

  // To a time in seconds; if one is under way, no more time is given.
  const begin = (seconds) => (jump = { picture: picture(), begun: performance.now(), arrived: Infinity, ...jump, seconds });
  const end = () => (jump = null);

  function isUnderWay() {
    const [now, { at, state }] = [performance.now(), window.hectorscope.timeline.state()];
    if (state !== "seeking" && Math.abs(at - jump.seconds) < 0.3) jump.arrived = Math.min(jump.arrived, now);
    return now < Math.min(jump.begun + LONGEST, jump.arrived + BEHIND) && picture() === jump.picture;
  }

  let held = null; // the renderer that asks
  drawing.push((_page, _scene, _camera, renderer) => {
    if (held === renderer) return;
    held = renderer;
    const render = renderer.render;
    renderer.render = (scene, camera) => {
      if (jump && scene === page().scene && isUnderWay()) return page().requestRender?.();
      end();
      return render.call(renderer, scene, camera);
    };
  });

  // A hand that turns the view sees it turn.
  for (const moved of ["pointerdown", "wheel"]) addEventListener(moved, ({ target }) => target === page()?.canvas && end(), { capture: true, passive: true });

  window.hectorscope.jump = { begin, end };
})();
