// A picture of the scene as this browser shows it, with the names of the levels, in the window's size or another one.
// The drawing is kept until the frame is shown only, so the picture is taken right after it was drawn.
"use strict";

(() => {
  const hectorscope = window.hectorscope;
  const LARGEST = 8192; // pixels on a side

  function save(blob, name = "hectorscope.png") {
    if (!blob) return;
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  // The names lie over the scene as elements of the page.
  function names(ctx, scale) {
    const home = document.querySelector(".hs-names");
    if (!home) return;
    const corner = home.getBoundingClientRect();
    ctx.textBaseline = "middle";
    for (const name of home.querySelectorAll("span")) {
      if (!name.checkVisibility()) continue;
      const [box, style] = [name.getBoundingClientRect(), getComputedStyle(name)];
      const [x, y] = [(box.left - corner.left) * scale, (box.top - corner.top) * scale];
      ctx.fillStyle = style.backgroundColor;
      ctx.fillRect(x, y, box.width * scale, box.height * scale);
      ctx.font = `${parseFloat(style.fontSize) * scale}px ${style.fontFamily}`;
      ctx.fillStyle = style.color;
      ctx.fillText(name.textContent, x + parseFloat(style.paddingLeft) * scale, y + (box.height / 2) * scale);
    }
  }

  function pictureOf(scene, ctx, width, height) {
    ctx.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--hs-background");
    ctx.fillRect(0, 0, width, height);
    ctx.drawImage(scene, 0, 0, width, height);
    if (Math.abs((width * scene.clientHeight) / (height * scene.clientWidth) - 1) < 0.01) names(ctx, width / scene.clientWidth);
  }

  // What is to be called once the scene has been drawn, while the drawing is there.
  const drawn = new Set();
  let after = null; // the scene that calls back
  let waiting = null; // what needs the renderer, once
  hectorscope.drawing.push((_page, scene, _camera, renderer) => {
    if (after !== scene) scene.onAfterRender = () => [...drawn].forEach((call) => call());
    after = scene;
    const act = waiting;
    waiting = null;
    if (act) requestAnimationFrame(() => act(renderer));
  });

  const wanted = () => /^(\d+)x(\d+)$/.exec(document.querySelector("[data-hs-size]")?.value ?? "")?.slice(1).map(Number);

  // Draws the scene once in another size, with the renderer that draws it always, which has its own size again then.
  function resized(page, [width, height], taken) {
    const { scene, camera } = page;
    waiting = (renderer) => {
      const [aspect, ratio, size] = [camera.aspect, renderer.getPixelRatio(), renderer.getSize(camera.position.clone())];
      const share = Math.min(1, Math.min(LARGEST, renderer.capabilities.maxTextureSize) / Math.max(width, height));
      const shape = (pixelRatio, wide, high, proportion) => {
        renderer.setPixelRatio(pixelRatio);
        renderer.setSize(wide, high, false);
        camera.aspect = proportion;
        camera.updateProjectionMatrix();
      };
      shape(1, Math.round(width * share), Math.round(height * share), width / height);
      hectorscope.enlarged = (height * share) / renderer.domElement.clientHeight;
      renderer.render(scene, camera);
      hectorscope.enlarged = 1;
      taken(renderer.domElement);
      shape(ratio, size.x, size.y, aspect);
      page.requestRender?.();
    };
    page.requestRender?.();
  }

  function take(scene) {
    const { width, height } = scene;
    const picture = Object.assign(document.createElement("canvas"), { width, height });
    pictureOf(scene, picture.getContext("2d"), width, height);
    picture.toBlob((blob) => save(blob), "image/png");
  }

  function picture() {
    const page = window.__viserMutable;
    if (!page?.canvas) return;
    hectorscope.jump.end(); // it is drawn as it is
    const size = wanted();
    if (size) {
      resized(page, size, take);
      return;
    }
    page.requestRender?.();
    requestAnimationFrame(() => take(page.canvas));
  }

  Object.assign(hectorscope, { enlarged: 1, picture, pictureOf, drawn, save });
})();
