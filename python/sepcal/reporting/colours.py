# SPDX-License-Identifier: BSD-3-Clause
"""Every colour of the figures, and what stands for it on a dark ground."""

from __future__ import annotations

DARK = {
    "#fff": "#15191d",  # the ground, and words on a bar
    "#1c2127": "#e6e9ec",  # ink
    "#1d2228": "#15191d",  # words on a bar that is pale in either theme
    "#5c6670": "#a5aeb7",  # quiet
    "#e6e9ec": "#30363c",  # grid
    "#b9c1c8": "#565f68",  # axes
    "#8b949c": "#78828b",  # zero
    "#9aa3ab": "#6f7881",  # measured
    "#2463a8": "#5fa3e8",  # modelled, first output
    "#b83a26": "#f0775f",  # alarm
    "#d98a2b": "#e5a24e",  # held out
    "#c4622d": "#ec8f5c",  # further outputs
    "#2c7a4b": "#5fbf86",
    "#7b4fa3": "#b58be0",
    "#8a6d1d": "#cfae4e",
    "#4a5560": "#9fb0c0",
    "#5b94cc": "#4f8fcc",  # bars
    "#f2f5f7": "#22282e",  # heat, from none
    "#f6c98f": "#6e4a20",
    "#dd7447": "#c4552c",
    "#a32a1c": "#ff9a80",
    "#e4edf6": "#1c2c3c",  # density, from few
    "#123f73": "#b5d8fa",
    "rgba(36,99,168,0.16)": "rgba(95,163,232,0.24)",
    "rgba(120,132,144,0.45)": "rgba(150,162,174,0.55)",
    "rgba(184,58,38,0.20)": "rgba(240,119,95,0.30)",
    "rgba(92,102,112,0.22)": "rgba(165,174,183,0.24)",
    "rgba(40,60,80,0.085)": "rgba(200,215,230,0.10)",
    "rgba(40,60,80,0.045)": "rgba(200,215,230,0.055)",
    "rgba(255,255,255,0.75)": "rgba(21,25,29,0.75)",
}
