// What view3d.js uses of three.js, and nothing else: all the rest is shaken off.
export {
  BufferAttribute,
  BufferGeometry,
  DoubleSide,
  GreaterDepth,
  Mesh,
  OrthographicCamera,
  Scene,
  ShaderMaterial,
  WebGLRenderer,
} from "three";
export { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
export { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
export { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
