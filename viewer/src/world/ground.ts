import type { Scene } from "three";
import { Color, DoubleSide, Mesh, PlaneGeometry, ShaderMaterial } from "three";

const vertex = /* glsl */ `
varying vec2 place;
#include <fog_pars_vertex>
void main() {
  vec4 world = modelMatrix * vec4(position, 1.0);
  place = world.xy;
  vec4 mvPosition = viewMatrix * world;
  gl_Position = projectionMatrix * mvPosition;
}`;

const fragment = /* glsl */ `
uniform vec3 line, axisX, axisY;
uniform float strength, reach;
varying vec2 place;
float lines(vec2 p, float step, float width) {
  vec2 c = p / step, w = fwidth(c);
  vec2 a = abs(fract(c - 0.5) - 0.5) / max(w, 1e-6);
  // lines closer than two pixels are faded out
  vec2 seen = 1.0 - smoothstep(0.25, 0.5, w);
  vec2 on = (1.0 - min(a / width, 1.0)) * seen;
  return max(on.x, on.y);
}
void main() {
  float far = 1.0 - smoothstep(0.2, 1.0, distance(place, cameraPosition.xy) / reach);
  float a = max(lines(place, 1.0, 1.0) * 0.35, lines(place, 10.0, 1.2) * 0.8) * strength * far;
  vec2 axis = 1.0 - min(abs(place) / max(fwidth(place) * 1.3, 1e-6), 1.0);
  vec3 color = line;
  if (axis.y > 0.0) { color = mix(color, axisX, axis.y); a = max(a, axis.y * 0.75 * far); }
  if (axis.x > 0.0) { color = mix(color, axisY, axis.x); a = max(a, axis.x * 0.75 * far); }
  if (a < 0.003) discard;
  gl_FragColor = vec4(color, a);
  #include <colorspace_fragment>
}`;

/** Offset below floors at the height of the ground, m. */
const BELOW = -0.02;

/** Ground lines at every metre and every ten metres, X red and Y green. */
export class Ground {
  private readonly uniforms = {
    line: { value: new Color(0x55606b) },
    axisX: { value: new Color(0xd2473c) },
    axisY: { value: new Color(0x4b9c3f) },
    strength: { value: 0.5 },
    reach: { value: 80 },
  };
  readonly mesh: Mesh<PlaneGeometry, ShaderMaterial>;

  constructor(scene: Scene) {
    const material = new ShaderMaterial({
      uniforms: this.uniforms,
      vertexShader: vertex,
      fragmentShader: fragment,
      transparent: true,
      depthWrite: false,
      side: DoubleSide,
      // a floor at the same height hides it, also at large distances
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 16,
    });
    this.mesh = new Mesh(new PlaneGeometry(1, 1), material);
    this.mesh.renderOrder = 1;
    this.mesh.frustumCulled = false;
    this.mesh.raycast = () => {};
    this.mesh.onBeforeRender = (_renderer, _scene, camera) => {
      // near the ground, lines can be distinguished only at short distances
      const [x, y, z] = camera.matrixWorld.elements.slice(12, 15) as [number, number, number];
      const reach = Math.min(300, 30 + 8 * Math.abs(z));
      this.uniforms.reach.value = reach;
      // no larger than visible: for very large triangles, the depth error of graphics cards exceeds the offset
      this.mesh.position.set(x, y, BELOW);
      this.mesh.scale.setScalar(2 * reach);
      this.mesh.updateMatrixWorld();
    };
    scene.add(this.mesh);
  }
}
