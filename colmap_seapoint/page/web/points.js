// The decimated cloud: 16-bit places in the plan, and colours.
const unpackCloud = (cloud) => {
  const codes = bytesOf(cloud.codes), places = new Float32Array(3 * cloud.count);
  for (let k = 0; k < places.length; ++k) places[k] = cloud.step * (codes[2 * k] | codes[2 * k + 1] << 8);
  return { places, colors: bytesOf(cloud.colors), low: cloud.low };
};

// Half the diagonal of what the points fill, and its middle; relative to cloud.low.
const extentOf = (places) => {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let k = 0; k < places.length; ++k) {
    const axis = k % 3;
    if (places[k] < low[axis]) low[axis] = places[k];
    if (places[k] > high[axis]) high[axis] = places[k];
  }
  const middle = low.map((value, axis) => (value + high[axis]) / 2);
  return { middle, radius: Math.hypot(...low.map((value, axis) => high[axis] - value)) / 2 || 1 };
};
