// The surface before and after, side by side under one camera. Draws only when something has changed.
import { ColorManagement, PerspectiveCamera, Quaternion, Scene, Spherical, Vector3, WebGLRenderer } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { quantile } from './data.js';
import * as overlays from './overlays.js';
import { Surface } from './surface.js';

const kFieldOfView = 35;
const kFilled = 0.86; // of the picture, by the surface
const kFarthest = 6; // times as far away as fills the picture, to have cameras and lights in it
const kLowest = 0.42, kHighest = 1.2; // radians above the horizon, to begin with

export class Viewer {
  // Throws where the browser has no WebGL 2.
  constructor(canvas, data, before, after) {
    this.canvas = canvas;
    this.data = data;
    ColorManagement.enabled = false; // colours are given as the screen shows them
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.outputColorSpace = 'srgb-linear';
    this.renderer.autoClear = false;
    this.camera = new PerspectiveCamera(kFieldOfView, 1, 0.005, 200);
    this.up = new Vector3(...data.scene.up);
    this.camera.up.copy(this.up);
    this.scene = new Scene();
    this.before = before && new Surface(before, data.scene.up);
    this.after = after && new Surface(after, data.scene.up);
    for (const surface of [this.before, this.after]) if (surface) this.scene.add(surface.object);
    this.overlays = {
      cameras: overlays.cameras(data.scene.views),
      rays: overlays.rays(data.contacts, data.scene.views),
      normals: overlays.normals(data.contacts),
      lights: overlays.lights(data.lights, data.scene.views),
    };
    for (const object of Object.values(this.overlays)) {
      object.visible = false;
      this.scene.add(object);
    }
    this.divide = 0; // share of the width, from the left, that shows the surface before
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', () => this.draw());
    this.controls.addEventListener('start', () => (this.untouched = false));
    this.untouched = true; // then the view may be chosen again, when the picture's size changes
    canvas.addEventListener('keydown', (event) => this.onKey(event));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    this.reset();
    this.resize();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.untouched) this.reset();
    else this.draw();
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.render();
    });
  }

  render() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    const split = this.before && this.after ? Math.round(this.divide * width) : this.before ? width : 0;
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    this.renderer.setScissorTest(true);
    for (const [shown, hidden, x, w] of [[this.before, this.after, 0, split], [this.after, this.before, split, width - split]]) {
      if (w <= 0) continue;
      if (hidden) hidden.object.visible = false;
      if (shown) shown.object.visible = true;
      this.renderer.setScissor(x, 0, w, height);
      this.renderer.render(this.scene, this.camera);
    }
  }

  // The range that both surfaces are coloured in.
  rangeOf(mode) {
    const values = [this.after, this.before].map((s) => s && s.mesh.attributes[mode.attribute]).find((v) => v);
    if (!values) return null;
    if (mode.id === 'confidence') return [0, 1];
    const high = quantile(values, 0.98);
    return mode.symmetric ? [-high, high] : [0, high];
  }

  hasColors() {
    return [this.before, this.after].some((s) => s && s.mesh.colors);
  }

  color(mode) {
    const [low, high] = this.rangeOf(mode) || [0, 1];
    for (const surface of [this.before, this.after]) if (surface) surface.show(mode, low, high);
    this.draw();
  }

  showOverlay(name, visible) {
    this.overlays[name].visible = visible;
    if (this.untouched) this.reset();
    else this.draw();
  }

  setDivide(share) {
    this.divide = Math.min(Math.max(share, 0), 1);
    this.draw();
  }

  // From the side of the camera that saw most highlights, a little from above, near enough to fill the picture with the
  // surface, or with the cameras and lights that are shown.
  reset() {
    const start = this.data.scene.views[this.data.scene.start];
    const towards = start ? new Vector3(...start.center).normalize() : new Vector3(0.6, 0.4, 1).normalize();
    const level = towards.clone().addScaledVector(this.up, -towards.dot(this.up));
    if (level.length() < 0.05) level.set(this.up.y, this.up.z, this.up.x).cross(this.up);
    const lift = Math.min(Math.max(Math.asin(Math.min(Math.max(towards.dot(this.up), -1), 1)), kLowest), kHighest);
    towards.copy(level.normalize()).multiplyScalar(Math.cos(lift)).addScaledVector(this.up, Math.sin(lift));
    this.camera.fov = kFieldOfView;
    this.camera.updateProjectionMatrix();
    this.controls.target.set(0, 0, 0);
    const near = this.distanceToFill(towards, this.positionsOfSurfaces());
    const far = this.distanceToFill(towards, this.positionsOfOverlays());
    this.camera.position.copy(towards).multiplyScalar(Math.min(Math.max(near, far), kFarthest * near));
    this.controls.update();
    this.untouched = true;
    this.draw();
  }

  positionsOfSurfaces() {
    return [this.before, this.after].filter((s) => s).map((s) => s.mesh.positions);
  }

  positionsOfOverlays() {
    const found = [];
    for (const object of [this.overlays.cameras, this.overlays.lights]) {
      if (!object.visible) continue;
      object.updateMatrixWorld(true);
      object.traverse((part) => {
        if (!part.geometry) return;
        const at = part.geometry.attributes.position.clone().applyMatrix4(part.matrixWorld);
        found.push(at.array);
      });
    }
    return found;
  }

  // From where all the points are in the picture, and fill it.
  distanceToFill(towards, all) {
    const right = this.up.clone().cross(towards).normalize(), above = towards.clone().cross(right);
    const tall = kFilled * Math.tan((kFieldOfView * Math.PI) / 360), wide = tall * this.camera.aspect;
    let distance = 0.1;
    const at = new Vector3();
    for (const positions of all) {
      for (let i = 0; i < positions.length; i += 3) {
        at.fromArray(positions, i);
        distance = Math.max(distance, at.dot(towards) + Math.max(Math.abs(at.dot(right)) / wide, Math.abs(at.dot(above)) / tall));
      }
    }
    return distance;
  }

  // As the camera of view `index` stood.
  lookFrom(index) {
    this.untouched = false;
    const { center, corners } = this.data.scene.views[index];
    const eye = new Vector3(...center);
    const rays = corners.map((ray) => new Vector3(...ray));
    const axis = rays.reduce((sum, ray) => sum.add(ray), new Vector3()).normalize();
    const top = rays[0].clone().add(rays[1]).normalize(), bottom = rays[2].clone().add(rays[3]).normalize();
    this.camera.fov = Math.min(Math.max((top.angleTo(bottom) * 180) / Math.PI, 5), 120);
    this.camera.updateProjectionMatrix();
    this.camera.position.copy(eye);
    this.controls.target.copy(eye).addScaledVector(axis, Math.max(-eye.dot(axis), 0.1));
    this.controls.update();
    this.draw();
  }

  orbit(turn, lift, zoom) {
    this.untouched = false;
    const offset = this.camera.position.clone().sub(this.controls.target);
    const toY = new Quaternion().setFromUnitVectors(this.up, new Vector3(0, 1, 0));
    const at = new Spherical().setFromVector3(offset.applyQuaternion(toY));
    at.theta += turn;
    at.phi = Math.min(Math.max(at.phi + lift, 0.01), Math.PI - 0.01);
    at.radius *= zoom;
    offset.setFromSpherical(at).applyQuaternion(toY.clone().invert());
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
  }

  onKey(event) {
    const moves = {
      ArrowLeft: [-0.1, 0, 1], ArrowRight: [0.1, 0, 1], ArrowUp: [0, -0.1, 1], ArrowDown: [0, 0.1, 1],
      '+': [0, 0, 0.9], '=': [0, 0, 0.9], '-': [0, 0, 1.1],
    };
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (moves[event.key]) this.orbit(...moves[event.key]);
    else if (event.key === '0' || event.key === 'Home') this.reset();
    else return;
    event.preventDefault();
  }
}
