const draw = (paths: string): string =>
  `<svg viewBox="0 0 20 20" width="18" height="18" fill="none" stroke="currentColor" stroke-width="1.7" ` +
  `stroke-linecap="round" stroke-linejoin="round" aria-hidden="true">${paths}</svg>`;

export const icons = {
  play: draw('<path d="M6 3.8v12.4L16 10z" fill="currentColor"/>'),
  pause: draw('<path d="M6.5 4.5v11M13.5 4.5v11" stroke-width="3"/>'),
  step: draw('<path d="M5 4.5v11l7.5-5.5z" fill="currentColor"/><path d="M15.5 4.5v11" stroke-width="2.4"/>'),
  back: draw('<path d="M15 4.5v11l-7.5-5.5z" fill="currentColor"/><path d="M4.5 4.5v11" stroke-width="2.4"/>'),
  reset: draw('<path d="M4 10a6 6 0 1 0 2-4.5"/><path d="M6.6 2v3.8H2.8"/>'),
  help: draw('<circle cx="10" cy="10" r="7.5"/><path d="M7.9 8a2.2 2.2 0 1 1 3.2 2c-.8.4-1.1.8-1.1 1.6"/><path d="M10 14.2v.1"/>'),
  sun: draw('<circle cx="10" cy="10" r="3.4"/><path d="M10 1.8v2M10 16.2v2M1.8 10h2M16.2 10h2M4.2 4.2l1.4 1.4M14.4 14.4l1.4 1.4M15.8 4.2l-1.4 1.4M5.6 14.4l-1.4 1.4"/>'),
  moon: draw('<path d="M16.5 12A7 7 0 0 1 8 3.5 7 7 0 1 0 16.5 12z"/>'),
  shot: draw('<rect x="2.5" y="5.5" width="15" height="11" rx="2"/><path d="M7 5.5l1.2-2h3.6l1.2 2"/><circle cx="10" cy="11" r="2.8"/>'),
  record: draw('<circle cx="10" cy="10" r="7"/><circle cx="10" cy="10" r="3" fill="currentColor"/>'),
  tree: draw('<path d="M3 4h6M6 9h8M6 14h8M3.5 4v10M6 9H3.5M6 14H3.5"/>'),
  panel: draw('<rect x="2.5" y="3.5" width="15" height="13" rx="2"/><path d="M12.5 3.5v13"/>'),
  plot: draw('<path d="M3 3v14h14"/><path d="M5.5 12.5l3-4 3 2.5 4.5-6"/>'),
  eye: draw('<path d="M1.8 10S5 4.5 10 4.5 18.2 10 18.2 10 15 15.5 10 15.5 1.8 10 1.8 10z"/><circle cx="10" cy="10" r="2.4"/>'),
  camera: draw('<rect x="2" y="5" width="11" height="10" rx="2"/><path d="M13 8.7l5-2.7v8l-5-2.7z"/>'),
  power: draw('<path d="M10 2.5v7"/><path d="M6 5a6.3 6.3 0 1 0 8 0"/>'),
  more: draw('<path d="M4.5 10h.1M10 10h.1M15.5 10h.1" stroke-width="2.8"/>'),
  close: draw('<path d="M5 5l10 10M15 5L5 15"/>'),
  wheel: draw('<circle cx="10" cy="10" r="7.5"/><circle cx="10" cy="10" r="1.8"/><path d="M2.8 9l5.4.6M17.2 9l-5.4.6M10 11.8v5.5"/>'),
  people: draw('<circle cx="7" cy="7" r="2.8"/><path d="M1.8 16.5c0-3 2.2-5 5.2-5s5.2 2 5.2 5"/><path d="M13 4.4a2.8 2.8 0 0 1 0 5.2M14.6 11.8c2.2.5 3.6 2.3 3.6 4.7"/>'),
  warn: draw('<path d="M10 3l8 14H2z"/><path d="M10 8.5v3.5M10 14.4v.1"/>'),
  copy: draw('<rect x="6.5" y="6.5" width="10" height="10" rx="2"/><path d="M13.5 6.5v-1a2 2 0 0 0-2-2h-6a2 2 0 0 0-2 2v6a2 2 0 0 0 2 2h1"/>'),
  move: draw('<path d="M10 2.5v15M2.5 10h15M7.5 5L10 2.5 12.5 5M7.5 15l2.5 2.5 2.5-2.5M5 7.5L2.5 10 5 12.5M15 7.5l2.5 2.5-2.5 2.5"/>'),
  focus: draw('<circle cx="10" cy="10" r="2.5"/><path d="M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4"/>'),
  robot: draw('<rect x="3.5" y="7" width="13" height="9" rx="2.5"/><path d="M10 7V4M10 3.5v.1M7.5 11v1M12.5 11v1M1.5 10.5v2.5M18.5 10.5v2.5"/>'),
  sensor: draw('<path d="M10 16a6 6 0 0 0-6-6M10 16a6 6 0 0 1 6-6M10 16V9" opacity=".001"/><circle cx="10" cy="14.5" r="1.6"/><path d="M6.5 11a5 5 0 0 1 7 0M3.8 8a9 9 0 0 1 12.4 0"/>'),
  actuator: draw('<circle cx="10" cy="10" r="2.6"/><path d="M10 2.5v2.4M10 15.1v2.4M2.5 10h2.4M15.1 10h2.4M4.7 4.7l1.7 1.7M13.6 13.6l1.7 1.7M15.3 4.7l-1.7 1.7M6.4 13.6l-1.7 1.7"/>'),
  chevron: draw('<path d="M7.5 5l5 5-5 5"/>'),
} as const;
