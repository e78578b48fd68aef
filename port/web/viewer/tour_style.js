// The CSS rules of markers, captions and the player, as a script, which bundlers and content security policies do not
// block.
export const rules = `
#markers { position: absolute; inset: 0; isolation: isolate; overflow: hidden; pointer-events: none; }
.marker { position: absolute; left: -15px; top: -15px; min-width: 30px; height: 30px; border-radius: 15px;
  background: var(--accent); color: var(--on); border: 2px solid var(--on); font-weight: 650; font-size: 13px;
  font-variant-numeric: tabular-nums; pointer-events: auto; transition: opacity 0.2s; box-shadow: 0 1px 5px #0006; }
.marker:hover { background: var(--accent); color: var(--on); filter: brightness(1.12); }
.marker.behind { opacity: 0.3; }
.marker[aria-expanded="true"] { background: var(--on); color: var(--accent); border-color: var(--accent); opacity: 1; }

#player, section { --bar: 60px; }
:host([ui]) :is(#player, section) { --bar: 0px; }
:host([ui~="tracks"]) :is(#player, section) { --bar: 6px; }
:host([ui]:not([ui~="annotations"])) :is(#markers, #caption), :host([ui]:not([ui~="tracks"])) #player {
  display: none !important; }
:host([ui]:not([ui~="annotations"])) #player { visibility: visible; }
:host(:is(:not([ui]), [ui~="tracks"])) #player:not([hidden]) ~ * { --track: 48px; }
section.panel { --under: calc(var(--bar) + var(--track, 0px) + var(--below, 0px)); bottom: calc(14px + var(--under));
  max-height: calc(100% - 32px - var(--under)); }
section:is(#caption, #trackKeys) { right: auto; left: calc(14px + var(--left, 0px)); }
section#caption { flex-direction: column; overflow: hidden; }
section#caption:not([hidden]) { display: flex; }
#caption header { gap: 8px; align-items: start; }
#caption h2 { max-height: 4.8em; padding-top: 8px; overflow: auto; overflow-wrap: anywhere; }
#captionText, #editing { min-height: 3em; overflow: auto; }
#captionText { padding-right: 10px; white-space: pre-line; overflow-wrap: anywhere; }
#caption footer { display: flex; align-items: center; gap: 2px; margin-top: 6px; color: var(--quiet); }
#place { flex: 1; text-align: center; font-variant-numeric: tabular-nums; }
:is(#caption, #trackKeys) :is(input, textarea) { display: block; width: calc(100% - 10px); margin: 4px 0;
  padding: 7px 9px; font: inherit; color: inherit; background: transparent; border: 1px solid var(--line);
  border-radius: 7px; }
#keyList { padding: 0 10px 0 22px; font-variant-numeric: tabular-nums; }
#keyList li::marker { color: var(--quiet); }
#trackKeys li > * { display: inline-block; vertical-align: middle; }
#trackKeys li input { width: 110px; }
#trackKeys li svg { margin: auto; }
#caption textarea { height: 90px; resize: vertical; }

#player { position: absolute; bottom: calc(8px + var(--bar) + var(--below, 0px)); left: 50%; transform: translateX(-50%);
  width: min(440px, calc(100% - 12px)); display: flex; align-items: center; padding: 3px; }
#player input { flex: 1; min-width: 60px; }
#player select { max-width: 120px; height: 30px; border: 0; background: transparent; text-overflow: ellipsis; }
#player output { min-width: 92px; text-align: center; color: var(--quiet); font-size: 13px; white-space: nowrap;
  font-variant-numeric: tabular-nums; }
#player:not([hidden]) ~ #note { bottom: calc(126px + var(--below, 0px)); }
#note:has(~ #caption:not([hidden])) { bottom: auto; top: calc(54px + var(--above, 0px)); z-index: 1; }

@container (max-width: 560px) {
  section#caption { left: 6px; right: 6px; width: auto; max-height: max(38%, min(150px, 100% - 12px)); }
}
@container (max-width: 400px) {
  #player, section { --bar: 40px; }
  section.panel { bottom: calc(6px + var(--below, 0px)); max-height: calc(100% - 12px); }
  section#caption { padding: 4px 6px 4px 14px; }
  #caption button { height: 32px; }
  #caption h2 { padding-top: 5px; }
  #caption footer { margin-top: 0; }
  #player { bottom: calc(12px + var(--bar) + var(--below, 0px)); }
  #player button { min-width: 32px; }
  #player output { min-width: 76px; }
}
@container (max-width: 300px) {
  #clock { display: none; }
}
@media (prefers-reduced-motion: reduce) {
  .marker { transition: none; }
}
`
