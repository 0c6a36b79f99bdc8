import { Euler, PerspectiveCamera, Quaternion, Vector3 } from "three";

/** Width of the sensor behind the lens, mm. */
const SENSOR = 32;
/** Tangent of half of the largest vertical field of view. */
const TALLEST = 1.1;
const UP = new Vector3(0, 0, 1);

export interface CameraPose {
  position: [number, number, number];
  yaw: number;
  pitch: number;
  roll: number;
}

/** The viewpoint: a position, a heading (about +Z, from +X), a pitch (upward) and a roll, in metres and radians. */
export class ViewCamera {
  readonly camera = new PerspectiveCamera(50, 1, 0.05, 500);
  readonly position = this.camera.position;
  yaw = 0;
  pitch = 0;
  roll = 0;
  private focal = 20;

  constructor() {
    this.camera.up.copy(UP);
  }

  /** As in scripts: Euler angles XYZ of a camera that looks along its -Z axis. */
  setRotation([x, y, z]: [number, number, number]): void {
    this.setQuaternion(new Quaternion().setFromEuler(new Euler(x, y, z, "ZYX")));
  }

  setQuaternion(rotation: Quaternion): void {
    const ahead = new Vector3(0, 0, -1).applyQuaternion(rotation);
    const top = new Vector3(0, 1, 0).applyQuaternion(rotation);
    this.pitch = Math.asin(Math.max(-1, Math.min(1, ahead.z)));
    // looking straight up or down: the up vector of the image gives the heading
    const flat = Math.hypot(ahead.x, ahead.y) > 1e-5 ? ahead : top.clone().multiplyScalar(-Math.sign(ahead.z));
    this.yaw = Math.atan2(flat.y, flat.x);
    this.roll = 0;
    this.update();
    const level = new Vector3(0, 1, 0).applyQuaternion(this.camera.quaternion);
    const side = new Vector3(1, 0, 0).applyQuaternion(this.camera.quaternion);
    this.roll = Math.atan2(-top.dot(side), top.dot(level));
    if (Math.abs(this.roll) < 1e-6) this.roll = 0;
    this.update();
  }

  get ahead(): Vector3 {
    const flat = Math.cos(this.pitch);
    return new Vector3(flat * Math.cos(this.yaw), flat * Math.sin(this.yaw), Math.sin(this.pitch));
  }

  get right(): Vector3 {
    return new Vector3(Math.sin(this.yaw), -Math.cos(this.yaw), 0);
  }

  get above(): Vector3 {
    return this.right.cross(this.ahead);
  }

  /** Rotate by angles; the pitch is limited below the vertical. */
  turn(yaw: number, pitch: number): void {
    this.yaw += yaw;
    this.pitch = Math.max(-1.569, Math.min(1.569, this.pitch + pitch));
    this.roll = 0;
  }

  lookAt(target: Vector3): void {
    const way = target.clone().sub(this.position);
    if (way.lengthSq() < 1e-12) return;
    this.pitch = Math.asin(Math.max(-1, Math.min(1, way.z / way.length())));
    if (Math.hypot(way.x, way.y) > 1e-6) this.yaw = Math.atan2(way.y, way.x);
    this.roll = 0;
  }

  get pose(): CameraPose {
    return { position: this.position.toArray(), yaw: this.yaw, pitch: this.pitch, roll: this.roll };
  }

  set pose({ position, yaw, pitch, roll }: CameraPose) {
    this.position.set(...position);
    Object.assign(this, { yaw, pitch, roll });
  }

  /** Focal length in mm for a sensor 32 mm wide, along the longer side of the image. */
  setLens(focal: number, near: number, far: number): void {
    this.focal = focal;
    Object.assign(this.camera, { near, far });
    this.setAspect(this.camera.aspect);
  }

  /** Near and far clipping distances, m. */
  setClip(near: number, far: number): void {
    Object.assign(this.camera, { near, far });
    this.camera.updateProjectionMatrix();
  }

  setAspect(aspect: number): void {
    const half = SENSOR / 2 / this.focal;
    this.camera.aspect = aspect;
    // a picture that is higher than wide shows as much of the width as it can without bending what it shows
    const upward = aspect > 1 ? half / aspect : Math.max(half, Math.min(half / aspect, TALLEST));
    this.camera.fov = (2 * Math.atan(upward) * 180) / Math.PI;
    this.camera.updateProjectionMatrix();
  }

  /** Update the camera of three.js. */
  update(): void {
    const { camera } = this;
    camera.quaternion.setFromEuler(new Euler(this.pitch + Math.PI / 2, 0, this.yaw - Math.PI / 2, "ZYX"));
    if (this.roll !== 0) camera.quaternion.multiply(new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), this.roll));
    camera.updateMatrixWorld();
  }
}
