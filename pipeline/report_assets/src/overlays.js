// What is drawn about the surface: cameras, the rays of highlights with their normals, lights.
import {
  BufferAttribute, BufferGeometry, ConeGeometry, Group, InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, Mesh,
  MeshBasicMaterial, SphereGeometry, Vector3,
} from 'three';
import { lightColor } from './dom.js';

const vector = (xyz) => new Vector3(...xyz);

function lines(points, color, opacity = 1) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(points.flatMap((p) => [p.x, p.y, p.z])), 3));
  const object = new LineSegments(geometry, new LineBasicMaterial({ color, opacity, transparent: opacity < 1, depthWrite: false }));
  object.frustumCulled = false;
  return object;
}

// Pyramids from the centre to the image, with a tick on its upper edge.
function frustum({ center, corners }, size) {
  const eye = vector(center);
  const [a, b, c, d] = corners.map((ray) => eye.clone().addScaledVector(vector(ray), size));
  const tip = a.clone().add(b).multiplyScalar(0.5).multiplyScalar(1.25).addScaledVector(c.clone().add(d).multiplyScalar(0.5), -0.25);
  return [eye, a, eye, b, eye, c, eye, d, a, b, b, c, c, d, d, a, a, tip, tip, b];
}

export function cameras(views) {
  const distances = views.map(({ center }) => vector(center).length()).sort((a, b) => a - b);
  const size = 0.05 * (distances[Math.floor(distances.length / 2)] || 1);
  return lines(views.flatMap((view) => frustum(view, size)), 0x5b8def, 0.9);
}

export function rays(contacts, views) {
  const group = new Group();
  for (const k of new Set(contacts.map((c) => c.light))) {
    const points = contacts.filter((c) => c.light === k).flatMap((c) => [vector(c.at), vector(views[c.view].center)]);
    group.add(lines(points, lightColor(k), 0.28));
  }
  return group;
}

export function normals(contacts) {
  const group = new Group();
  const dot = new SphereGeometry(0.0035, 10, 8);
  for (const k of new Set(contacts.map((c) => c.light))) {
    const own = contacts.filter((c) => c.light === k);
    group.add(lines(own.flatMap((c) => [vector(c.at), vector(c.at).addScaledVector(vector(c.normal), 0.06)]), lightColor(k)));
    const balls = new InstancedMesh(dot, new MeshBasicMaterial({ color: lightColor(k) }), own.length);
    own.forEach((c, i) => balls.setMatrixAt(i, new Matrix4().setPosition(...c.at)));
    balls.frustumCulled = false;
    group.add(balls);
  }
  return group;
}

// A lamp with its beam to the object, and the cone of two standard deviations.
function distantLight(direction, sigma_deg, color) {
  const group = new Group();
  const to = vector(direction).normalize();
  const lamp = new Mesh(new SphereGeometry(0.03, 20, 14), new MeshBasicMaterial({ color }));
  lamp.position.copy(to).multiplyScalar(1.15);
  group.add(lamp, lines([lamp.position, to.clone().multiplyScalar(0.2)], color));
  if (sigma_deg > 0) {
    const half = Math.min((2 * sigma_deg * Math.PI) / 180, 1.2);
    const cone = new ConeGeometry(0.95 * Math.tan(half), 0.95, 40, 1, true);
    const body = new Mesh(cone, new MeshBasicMaterial({ color, transparent: true, opacity: 0.16, side: 2, depthWrite: false }));
    body.position.copy(to).multiplyScalar(0.2 + 0.475);
    body.quaternion.setFromUnitVectors(new Vector3(0, -1, 0), to);
    group.add(body);
  }
  return group;
}

function pointLight(at, sigma, color) {
  const group = new Group();
  const lamp = new Mesh(new SphereGeometry(0.03, 20, 14), new MeshBasicMaterial({ color }));
  lamp.position.set(...at);
  group.add(lamp, lines([lamp.position, vector(at).multiplyScalar(0.2)], color, 0.5));
  if (sigma > 0) {
    const cloud = new Mesh(new SphereGeometry(2 * sigma, 24, 16), new MeshBasicMaterial({ color, transparent: true, opacity: 0.16, depthWrite: false }));
    cloud.position.set(...at);
    group.add(cloud);
  }
  return group;
}

// Of a light that goes with the camera: where it is, or a stroke towards it, at every camera.
function carriedLight({ distant, vectors }, views, color) {
  return lines(
    vectors.flatMap((xyz, v) => {
      const eye = vector(views[v].center);
      return [eye, distant ? eye.clone().addScaledVector(vector(xyz).normalize(), 0.15) : vector(xyz)];
    }),
    color,
  );
}

export function lights(list, views) {
  const group = new Group();
  list.forEach((light, k) => {
    const color = lightColor(k);
    if (!light.world) group.add(carriedLight(light, views, color));
    else group.add((light.distant ? distantLight : pointLight)(light.vectors[0], light.sigma, color));
  });
  return group;
}
