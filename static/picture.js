// A picture of the scene as this browser shows it, saved as a file. The drawing is kept until the frame is shown only,
// so the picture is taken in the same frame: after the scene's own callback, which was asked for earlier.
"use strict";

(() => {
  const NAME = "hectorscope.png";

  function save(blob) {
    if (!blob) return;
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: NAME });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  function picture() {
    const page = window.__viserMutable;
    page?.requestRender?.();
    requestAnimationFrame(() => page?.canvas?.toBlob(save, "image/png"));
  }

  window.hectorscope = Object.assign(window.hectorscope ?? {}, { picture });
})();
