// The colours of the scene in this browser's theme, cells without blur, points that are seen from afar, and the
// layers that this browser hides. The server draws for all in one set of colours (--hs-sent-...).
//
// viser leaves its internals at window.__viserMutable. They are no interface: everything here looks before it
// touches, and without them the page still shows everything, with blurred cells and in the dark theme.
"use strict";

(() => {
  const { own, drawing } = window.hectorscope;
  const NEAREST = 1003; // THREE.NearestFilter
  const POINT_SIZE = "gl_PointSize = (scale / -world_pos.z)"; // as viser writes it
  const POINT_COLOUR = "vColor = color;";
  const POINT_PIXELS = 3;
  const LINES = { "/trajectory/": "trajectory", "/truth/": "truth", "/compared/": "compared", "/floor/footprint": "robot" };
  const CELLS = /^\/floor\/map\/level(\d+)\/cells$/;
  const INSIDE = /^\/floor\/map\/level\d+\/xray\/points$/;
  const WALLS = "/floor/compared_map/cells"; // white: they are painted here
  const SOLIDS = { "/robot/hull": "robot", "/position/ellipsoid": "position" };
  for (const key of ["prior", "match", "fused"]) {
    LINES[`/floor/${key}/pose/rim`] = key;
    SOLIDS[`/floor/${key}/pose/disc`] = key;
  }

  // ------------------------------------------------------------------------------------------- colours

  let palette = null;
  const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
  const linear = (share) => (share > 0.04045 ? ((share + 0.055) / 1.055) ** 2.4 : share / 12.92);
  const vec = (colour) => `vec3(${colour.map((c) => c.toFixed(5)).join(",")})`;
  const list = (name) => own.style(name).split(/\s+/);

  function colours() {
    if (palette?.theme === own.get("theme")) return palette;
    palette = {
      theme: own.get("theme"),
      of: (name) => rgb(list(name)[0]),
      ramp: list("ramps").map(rgb),
      sentRamp: list("sent-ramps").map(rgb),
      veil: list("veil").map(Number),
    };
    return palette;
  }

  const paint = (colour, shares) => colour?.setRGB?.(...shares, "srgb");

  // -------------------------------------------------------------------------------------------- things

  // Lines leave the film curve out, so that they have the colours of the legend.
  function line(material, colour) {
    if (material.toneMapped || material.vertexColors) {
      Object.assign(material, { toneMapped: false, vertexColors: false, needsUpdate: true });
    }
    paint(material.color, colour);
  }

  function grid(material, colour) {
    material.depthWrite = false; // seen from afar, lines just below the map would cut it
    for (const name of ["cellColor", "sectionColor"]) paint(material.uniforms?.[name]?.value, colour);
  }

  // A surfel comes as a grey that says how much it counts.
  function surfel(material, { theme, of }) {
    if (material.userData.dressed === theme) return;
    material.userData.dressed = theme;
    const plain = (material.userData.plain ??= material.fragmentShader);
    const [none, whole] = [of("free"), of("accent")].map((colour) => vec(colour.map(linear)));
    material.fragmentShader = plain.replace("#include <color_fragment>", `diffuseColor.rgb = mix(${none}, ${whole}, vColor.x);`);
    Object.assign(material, { toneMapped: false, needsUpdate: true });
  }

  // viser makes a material for each scan, and three.js deletes a program with the last material that has it. To compile
  // a program takes longer than all else of a scan, so the first material of each is not given up.
  const lasting = new WeakSet();
  function outlast(material, { properties }) {
    if (material.userData.outlasts) return;
    material.userData.outlasts = true;
    const dispose = material.dispose;
    material.dispose = () => {
      const { currentProgram } = properties.get(material);
      if (!currentProgram || lasting.has(currentProgram)) dispose.call(material);
      else lasting.add(currentProgram);
    };
  }

  // Each point has the colour of its residual on the sent ramp, or that of a surprise, or the accent.
  function recolouring({ of, ramp: [A, B, C], sentRamp: [a, b, c] }) {
    const single = ["unexpected", "accent"].map(
      (name) => `if (distance(c, ${vec(of(`sent-${name}`))}) < 0.01) return ${vec(of(name))};`);
    return `vec3 dressed(vec3 c) {
      ${single.join("\n")}
      vec3 a = ${vec(a)}, b = ${vec(b)}, d = ${vec(c)};
      float s = clamp(dot(c - a, b - a) / dot(b - a, b - a), 0.0, 1.0), t = clamp(dot(c - b, d - b) / dot(d - b, d - b), 0.0, 1.0);
      return distance(c, mix(a, b, s)) <= distance(c, mix(b, d, t)) ? mix(${vec(A)}, ${vec(B)}, s) : mix(${vec(B)}, ${vec(C)}, t);
    }
    void main() {`;
  }

  // Points keep a few pixels; transparent is what is drawn after the map instead of cut by it.
  function points(material, worn, renderer) {
    outlast(material, renderer);
    if (material.uniforms?.hsPixels) material.uniforms.hsPixels.value = POINT_PIXELS * (window.hectorscope.enlarged ?? 1);
    if (material.userData.dressed === worn.theme || !material.vertexShader?.includes(POINT_SIZE) && !material.userData.plain) return;
    material.userData.dressed = worn.theme;
    const plain = (material.userData.plain ??= material.vertexShader);
    const wide = plain.replace(POINT_SIZE, "gl_PointSize = max(hsPixels, scale / -world_pos.z)");
    material.uniforms.hsPixels ??= { value: POINT_PIXELS };
    material.vertexShader = wide.replace("void main() {", `uniform float hsPixels;\n${recolouring(worn)}`).replace(POINT_COLOUR, "vColor = dressed(color);");
    Object.assign(material, { transparent: true, needsUpdate: true });
  }

  // Its values as they are: to make the smaller pictures of sRGB takes several times as long.
  function crisp(material) {
    const texture = material.map;
    if (texture && texture.magFilter !== NEAREST) Object.assign(texture, { magFilter: NEAREST, anisotropy: 4, colorSpace: "", needsUpdate: true });
    material.depthWrite = false; // what is transparent must not hide what lies below
  }

  // Free and occupied cells; those of a level over others are veiled.
  function cells(material, { of, veil }, veiled) {
    crisp(material);
    const wear = (material.userData.wear ??= compiled(material, of));
    [wear.free.value, wear.wall.value] = [of("free"), of("occupied")].map((colour) => colour.map(linear));
    wear.veil.value = veiled ? veil : [1, 1];
  }

  function walls(material, colour) {
    crisp(material);
    paint(material.color, colour);
  }

  function compiled(material, of) {
    const wear = { free: { value: [0, 0, 0] }, wall: { value: [0, 0, 0] }, veil: { value: [1, 1] } };
    const [low, high] = [of("sent-free"), of("sent-occupied")].map(([red]) => red.toFixed(5));
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, { hsFree: wear.free, hsWall: wear.wall, hsVeil: wear.veil });
      shader.fragmentShader = `uniform vec3 hsFree; uniform vec3 hsWall; uniform vec2 hsVeil;\n${shader.fragmentShader.replace(
        "#include <map_fragment>",
        `#include <map_fragment>
        #ifdef USE_MAP
          float hsShare = clamp((diffuseColor.r - ${low}) / (${high} - ${low}), 0.0, 1.0);
          diffuseColor = vec4(mix(hsFree, hsWall, hsShare), diffuseColor.a * mix(hsVeil.x, hsVeil.y, hsShare));
        #endif`)}`;
    };
    material.customProgramCacheKey = () => "hectorscope cells";
    material.needsUpdate = true;
    return wear;
  }

  // --------------------------------------------------------------------------------------------- frames

  // What is drawn by a node itself, not by nodes below it.
  function drawn(page, name, act) {
    const walk = (object) => {
      if (object.material) act(object.material, object);
      for (const child of object.children) if (!named.has(child)) walk(child);
    };
    const node = page.nodeRefFromName[name];
    if (node) walk(node);
  }

  let named = new Set();
  const key = (table, name) => table[name] ?? table[`${name.split("/").slice(0, -1).join("/")}/`];

  drawing.push((page, _scene, _camera, renderer) => {
    const worn = colours();
    const { places } = window.hectorscope.levels();
    named = new Set(Object.values(page.nodeRefFromName));
    for (const name of Object.keys(page.nodeRefFromName)) {
      const [stroke, solid] = [key(LINES, name), SOLIDS[name]];
      if (stroke) drawn(page, name, (material) => line(material, worn.of(stroke)));
      else if (solid) drawn(page, name, (material) => paint(material.color, worn.of(solid)));
      else if (name === "/floor/surfels/lines") drawn(page, name, (material) => surfel(material, worn));
      else if (name === "/floor/scan/points" || INSIDE.test(name)) drawn(page, name, (material) => points(material, worn, renderer));
      else if (name === "/floor/grid/lines") drawn(page, name, (material) => grid(material, worn.of("grid")));
      else if (name === WALLS) drawn(page, name, (material) => walls(material, worn.of("compared")));
      else if (CELLS.test(name)) drawn(page, name, (material) => cells(material, worn, places[name.match(CELLS)[1]]?.z > 0));
    }
    hide(page);
  });

  // Layers that this browser does not show. A layer on demand is asked for as soon as it is to be seen.
  const asked = new Set();
  function hide(page) {
    for (const [name, { nodes, ask }] of Object.entries(own.layers())) {
      const shown = own.layerShown(name);
      for (const node of nodes) if (page.nodeRefFromName[node] && !shown) page.nodeRefFromName[node].visible = false;
      if (!shown || !ask || asked.has(ask)) continue;
      asked.add(ask);
      page.sendMessage?.({ type: "GuiUpdateMessage", uuid: ask, updates: { value: true } });
    }
  }
})();
