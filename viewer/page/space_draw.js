// The picture of a mechanism in space: solids by three.js from the scene's glTF, and over it what marks.js draws.

const EDGES = "#1f3a5f", SIDES = 10, TRIAD = ["#c0392b", "#2e7d32", "#1f5fbf"];
const solid = document.getElementById("solid");
const world = new THREE.Scene(), lens = new THREE.OrthographicCamera(), sun = new THREE.DirectionalLight(0xffffff, 1.9);
const tubes = scene.bands.map((band) => new THREE.Mesh(tubeGeometry(band), new THREE.MeshStandardMaterial({ roughness: 0.7, vertexColors: true })));
let renderer = null, mixer = null, span = 0;

lens.matrixAutoUpdate = false;
world.add(new THREE.HemisphereLight(0xffffff, 0xb9c4d0, 1.9), sun, sun.target);
const upper = new THREE.Group(); // of what is drawn in the model's axes
upper.matrixAutoUpdate = false;
upper.matrix.makeBasis(...[0, 1, 2].map((k) => new THREE.Vector3(RIGHT_AXIS[k], UP_AXIS[k], TOWARDS_AXIS[k])));
for (const tube of tubes) upper.add(tube);
world.add(upper);
try {
  renderer = new THREE.WebGLRenderer({ canvas: solid, antialias: true });
  renderer.setClearColor("#fbfcfe");
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = THREE.PCFShadowMap;
} catch (error) {
  document.getElementById("missing").textContent = "This browser cannot draw in space: it has no WebGL. Switch its hardware acceleration on, try another browser, or make a film of the run (a name that ends with .gif). Time line and plots work.";
}

const bytes = Uint8Array.from(atob(scene.solids), (letter) => letter.charCodeAt(0));
const ready = new THREE.GLTFLoader().parseAsync(bytes.buffer, "").then((loaded) => {
  const edges = new Map();
  const meshes = [];
  loaded.scene.traverse((node) => { if (node.isMesh) meshes.push(node); });
  for (const mesh of [...meshes, ...tubes]) {
    const clear = mesh.material.transparent, flat = !mesh.geometry.boundingBox && mesh.geometry.computeBoundingBox();
    const box = mesh.geometry.boundingBox, plate = box && box.max.z - box.min.z < 1e-9;
    mesh.castShadow = !clear && !plate && flat !== null;
    mesh.receiveShadow = true;
    if (plate || clear || tubes.includes(mesh)) continue;
    if (!edges.has(mesh.geometry)) edges.set(mesh.geometry, new THREE.EdgesGeometry(mesh.geometry, 40));
    mesh.add(new THREE.LineSegments(edges.get(mesh.geometry), new THREE.LineBasicMaterial({ color: EDGES, transparent: true, opacity: 0.5 })));
  }
  world.add(loaded.scene);
  if (loaded.animations.length) {
    mixer = new THREE.AnimationMixer(loaded.scene);
    mixer.clipAction(loaded.animations[0]).play();
    span = loaded.animations[0].duration;
  }
  redraw();
});

// A tube along a cable; its places are filled in for each picture.
function tubeGeometry(band) {
  const count = band.points.shape[1], geometry = new THREE.BufferGeometry(), index = [];
  for (const name of ["position", "normal", "color"]) geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * SIDES * count), 3));
  for (let k = 0; k + 1 < count; k++) {
    for (let i = 0; i < SIDES; i++) {
      const a = k * SIDES + i, b = k * SIDES + ((i + 1) % SIDES);
      index.push(a, a + SIDES, b, b, a + SIDES, b + SIDES);
    }
  }
  geometry.setIndex(index);
  return geometry;
}

function bend(tube, band, where) {
  const count = band.points.shape[1], place = tube.geometry.attributes.position, normal = tube.geometry.attributes.normal;
  const radius = 0.005 * band.width * scene.size, points = Array.from({ length: count }, (_, k) => bandPoint(band, where, k));
  const field = band.fields[chosen.get(band)], shade = new THREE.Color(), tint = tube.geometry.attributes.color;
  let across = null;
  for (let k = 0; k < count; k++) {
    shade.set(field ? colour(at(field.values, where, count, k) / field.limit) : FLEX);
    const ahead = unit(sum(points[Math.min(k + 1, count - 1)], points[Math.max(k - 1, 0)], -1));
    across = across || (Math.abs(ahead[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]);
    across = unit(sum(across, ahead, -dot(across, ahead)));
    const third = cross(ahead, across);
    for (let i = 0; i < SIDES; i++) {
      const angle = (2 * Math.PI * i) / SIDES, out = across.map((x, j) => Math.cos(angle) * x + Math.sin(angle) * third[j]);
      normal.setXYZ(k * SIDES + i, ...out);
      tint.setXYZ(k * SIDES + i, shade.r, shade.g, shade.b);
      place.setXYZ(k * SIDES + i, ...sum(points[k], out, radius));
    }
  }
  place.needsUpdate = normal.needsUpdate = tint.needsUpdate = true;
  tube.frustumCulled = false;
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function unit(a) {
  const size = Math.hypot(...a) || 1;
  return a.map((x) => x / size);
}

function sized() {
  if (!renderer) return;
  renderer.setPixelRatio(window.devicePixelRatio || 1);
  renderer.setSize(camera.width, camera.height, false);
}

function render() {
  const [right, up, towards] = eyeAxes().map((axis) => new THREE.Vector3(...axis));
  const target = new THREE.Vector3(...upright(camera.target)), far = 20 * scene.size + (camera.width + camera.height) / camera.scale;
  lens.left = -(lens.right = (0.5 * camera.width) / camera.scale);
  lens.bottom = -(lens.top = (0.5 * camera.height) / camera.scale);
  lens.near = 0;
  lens.far = 2 * far;
  lens.matrix.makeBasis(right, up, towards).setPosition(target.clone().addScaledVector(towards, far));
  lens.matrixWorldNeedsUpdate = true;
  lens.updateProjectionMatrix();
  const half = 0.75 * Math.max(camera.width, camera.height) / camera.scale, shade = sun.shadow;
  sun.castShadow = true;
  sun.target.position.copy(target);
  sun.position.copy(target).add(new THREE.Vector3(0.45, 1, 0.3).multiplyScalar(2 * half));
  Object.assign(shade.camera, { left: -half, right: half, top: half, bottom: -half, near: 0, far: 6 * half });
  shade.camera.updateProjectionMatrix();
  shade.mapSize.set(2048, 2048);
  shade.bias = -0.0005;
  shade.normalBias = 0.004 * half;
  renderer.render(world, lens);
}

function drawScene(g, time) {
  const where = place(time);
  if (camera.follow) camera.target = vectorAt(scene.frames[camera.follow].motion, where, POSE, 0);
  scene.bands.forEach((band, k) => bend(tubes[k], band, where));
  if (mixer) mixer.setTime(Math.min(time - first, span * (1 - 1e-7)));
  if (renderer) render();
  g.clearRect(0, 0, camera.width, camera.height);
  g.lineJoin = g.lineCap = "round";
  if (shows.trails && !still) drawTrails(g, where);
  drawGauges(g, where);
  if (shows.names) drawNames(g, where);
  if (shows.velocities) drawVelocities(g, where);
  drawForces(g, where, time);
  drawScale(g);
  drawTriad(g);
}

// Place and axes of a frame as it is drawn: twelve numbers in the model's axes.
function placed(name) {
  const node = world.getObjectByName(name.replace(/[\[\].:\/\s]/g, (letter) => (letter.trim() ? "" : "_")));
  node.updateWorldMatrix(true, false);
  const e = node.matrixWorld.elements;
  return [12, 0, 4, 8].flatMap((k) => modelled([e[k], e[k + 1], e[k + 2]]));
}

// The model's axes, in the corner, above the legend of the colours.
function drawTriad(g) {
  const legend = document.getElementById("legend"), above = legend.hidden ? 0 : legend.offsetHeight + 8;
  const [right, up, towards] = eyeAxes(), x = camera.width - 46, y = camera.height - 44 - above;
  const ends = [0, 1, 2].map((k) => upright([0, 1, 2].map((i) => (i === k ? 1 : 0))));
  const order = [0, 1, 2].sort((a, b) => dot(towards, ends[a]) - dot(towards, ends[b]));
  for (const k of order) {
    const dx = 30 * dot(right, ends[k]), dy = -30 * dot(up, ends[k]);
    drawArrow(g, [x, y], [x + dx, y + dy], TRIAD[k]);
    drawText(g, "xyz"[k], x + 1.3 * dx, y + 1.3 * dy, TRIAD[k], "center");
  }
}
