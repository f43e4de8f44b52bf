// Colours of numbers, as red, green and blue from 0 to 1 in sRGB; those of sieve
// fractions and of the plate come with the run.

// Matplotlib's viridis at eleven points: even steps look even, also in grey
// and to eyes that do not tell red from green. Its dark end is lifted, so that
// light and shade can still be seen on it.
const VIRIDIS = ["#440154", "#482475", "#414487", "#355f8d", "#2a788e", "#21918c", "#22a884", "#44bf70", "#7ad151", "#bddf26", "#fde725"];

// Its inferno without the black end, for forces.
const INFERNO = ["#57106e", "#7f1e6c", "#a52c60", "#c73e4c", "#e25734", "#f37819", "#fca50a", "#f6d746", "#fcffa4"];

export const UNKNOWN = [0.62, 0.62, 0.62];

export const parsed = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16) / 255);
const lifted = (rgb, k, all) => rgb.map((c) => c + 0.22 * (1 - k / (all.length - 1)) * (1 - c));
const scales = { viridis: VIRIDIS.map(parsed).map(lifted), inferno: INFERNO.map(parsed) };

// The colour at a place along some colours, counted from 0.
function blended(stops, place) {
  const k = Math.min(Math.floor(place), stops.length - 2);
  return stops[k].map((from, c) => from + (place - k) * (stops[k + 1][c] - from));
}

// The colour at a share from 0 to 1 of a scale.
export function colourAt(name, share) {
  const stops = scales[name];
  return blended(stops, Math.min(Math.max(share, 0), 1) * (stops.length - 1));
}

export const css = (rgb) => `rgb(${rgb.map((c) => Math.round(255 * c)).join(" ")})`;

// As light adds up: shading is done in these.
export const linear = (rgb) => rgb.map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));

// A scale as the background of a legend.
export function gradient(name) {
  const stops = Array.from({ length: 11 }, (_, k) => css(colourAt(name, k / 10)));
  return `linear-gradient(to right, ${stops.join(", ")})`;
}
