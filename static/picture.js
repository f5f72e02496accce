// A picture of the scene as this browser shows it, with the names of the levels, saved as a file. The drawing is kept
// until the frame is shown only, so the picture is taken in the same frame: after the scene's own callback, which was
// asked for earlier.
"use strict";

(() => {
  const NAME = "hectorscope.png";

  function save(blob) {
    if (!blob) return;
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: NAME });
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

  function take(scene) {
    const { width, height } = scene;
    const picture = Object.assign(document.createElement("canvas"), { width, height });
    const ctx = picture.getContext("2d");
    ctx.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--hs-background");
    ctx.fillRect(0, 0, width, height);
    ctx.drawImage(scene, 0, 0);
    names(ctx, width / scene.clientWidth);
    picture.toBlob(save, "image/png");
  }

  function picture() {
    const page = window.__viserMutable;
    page?.requestRender?.();
    requestAnimationFrame(() => page?.canvas && take(page.canvas));
  }

  window.hectorscope = Object.assign(window.hectorscope ?? {}, { picture });
})();
