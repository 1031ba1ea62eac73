/* The Validate button of a notebook, in the place of nbgrader's.

JupyterLab loads this file as it is: a module federation container, written by hand, so that it
needs no build. What it shows is text; nothing in a report is read as HTML. */
(() => {
  'use strict';

  const NAME = 'my_robot_basics_validate';
  const URL_PATH = 'my_robot_basics/validate';
  const PROGRESS = new URL('progress.js', document.currentScript.src);
  let shared = {};

  /** Return a module of JupyterLab's own. */
  async function lab(name) {
    const [provider] = Object.values(shared[name]);
    return (await provider.get())();
  }

  /** Make an element: text between backticks becomes code, children are appended. */
  function element(tag, className, ...content) {
    const made = document.createElement(tag);
    if (className) made.className = `mrb-validate-${className}`;
    for (const each of content) {
      if (typeof each !== 'string') {
        made.append(each);
        continue;
      }
      each.split('`').forEach((piece, i) => {
        made.append(i % 2 ? Object.assign(document.createElement('code'), { textContent: piece }) : piece);
      });
    }
    return made;
  }

  /** Return a text in the language of a report, with values in its places. */
  const say = (words, text, values = {}) =>
    (words[text] ?? text).replace(/\{(\w+)\}/g, (place, name) => values[name] ?? place);
  const MORE = {
    'at grading': 'checked only at grading',
    'by hand': 'a person reads it',
    'not checked': 'could not be checked'
  };

  function showCheck(check, marks, words) {
    const more = MORE[check.outcome] || (check.is_partly_hidden ? 'more checks at grading' : '');
    const missed = ['failed', 'partial'].includes(check.outcome);
    const points = say(words, check.points === 1 ? '{number} point' : '{number} points', { number: check.points });
    const score = missed ? say(words, '{earned} of {points}', { earned: check.earned, points }) : points;
    const row = element('li', check.outcome.replace(' ', '-'));
    const mark = element('span', 'mark', marks[check.outcome]);
    mark.setAttribute('aria-label', say(words, MORE[check.outcome] ?? check.outcome));
    mark.setAttribute('role', 'img');
    row.append(
      element('div', 'row', mark, element('span', 'title', check.title),
        element('span', 'points', more ? say(words, '{score}, {more}', { score, more: say(words, more) }) : score))
    );
    if (check.message) row.append(element('p', 'message', check.message));
    for (const note of check.notes) row.append(element('p', 'note', note));
    for (const picture of check.pictures) {
      const image = element('img', 'picture');
      image.src = `data:image/png;base64,${picture.png}`;
      image.alt = picture.alt;
      row.append(image);
    }
    if (check.source && missed) {
      const code = document.createElement('pre');
      code.textContent = check.source;
      row.append(element('details', '', element('summary', '', say(words, 'Show the check')), code));
    }
    return row;
  }

  /** Show what stands around a report in its language. */
  function showWords(body, words) {
    const dialog = body.closest('.jp-Dialog-content');
    for (const [part, text] of [['header', 'Validation Results'], ['buttonLabel', 'Close']]) {
      const shown = dialog?.querySelector(`.jp-Dialog-${part}`);
      if (!shown || words[text] === text) continue;
      shown.textContent = words[text];
      shown.closest('button')?.setAttribute('aria-label', words[text]);
    }
  }

  function showReport(body, report) {
    showWords(body, report.words);
    body.replaceChildren(element('p', report.passed ? 'summary' : 'summary mrb-validate-bad', report.summary));
    for (const note of report.notes) body.append(element('p', 'message', note));
    for (const part of report.parts) {
      body.append(element('h3', '', `\`${part.name}\``));
      for (const trouble of part.troubles) body.append(element('p', 'message', trouble));
      body.append(element('ul', '', ...part.checks.map(check => showCheck(check, report.marks, report.words))));
    }
  }

  function showLine(body, line) {
    const shown = element('p', 'progress', line);
    shown.setAttribute('role', 'status');
    body.replaceChildren(shown);
  }

  /** Take what the server writes line by line: steps, and at the end a report or why there is none. */
  async function follow(response, body) {
    const reader = response.body.getReader();
    const decoder = new TextDecoder();
    let text = '';
    for (;;) {
      const { done, value } = await reader.read();
      text += decoder.decode(value, { stream: !done });
      const lines = text.split('\n');
      text = lines.pop();
      for (const line of lines.filter(Boolean).map(JSON.parse)) {
        if (line.words) showWords(body, line.words);
        if (line.progress) showLine(body, `${line.progress} …`);
        if (line.report) showReport(body, line.report);
        if (line.failed) showLine(body, line.failed);
      }
      if (done) return;
    }
  }

  const pathOf = panel => panel.context.localPath ?? panel.context.path;

  /** Return what the button and its dialog say for a notebook; what is missing is in English. */
  async function wordsFor(panel, { services, coreutils }) {
    const settings = services.ServerConnection.makeSettings();
    const address = coreutils.URLExt.join(settings.baseUrl, URL_PATH);
    const query = coreutils.URLExt.objectToQueryString({ path: pathOf(panel) });
    try {
      const response = await services.ServerConnection.makeRequest(address + query, {}, settings);
      return response.ok ? (await response.json()).words : {};
    } catch {
      return {};
    }
  }

  async function validate(panel, button, words, { apputils, services, coreutils, widgets }) {
    const body = element('div', 'report');
    const node = new widgets.Widget({ node: body });
    const dialog = new apputils.Dialog({
      title: say(words, 'Validation Results'),
      body: node,
      buttons: [apputils.Dialog.okButton({ label: say(words, 'Close') })]
    });
    const stop = new AbortController();
    button.enabled = false;
    dialog.launch().finally(() => stop.abort());
    try {
      showLine(body, '…');
      await panel.context.save();
      const settings = services.ServerConnection.makeSettings();
      const response = await services.ServerConnection.makeRequest(
        coreutils.URLExt.join(settings.baseUrl, URL_PATH),
        { method: 'POST', body: JSON.stringify({ path: pathOf(panel) }), signal: stop.signal },
        settings
      );
      if (!response.ok) {
        const status = `${response.status} ${response.statusText}`;
        throw new Error(say(words, 'the server answered {status}', { status }));
      }
      await follow(response, body);
    } catch (error) {
      if (!stop.signal.aborted) showLine(body, say(words, 'Validate could not run: {why}', { why: error.message }));
    } finally {
      button.enabled = true;
    }
  }

  const STYLE = `
    .jp-Dialog-content:has(.mrb-validate-report) { width: min(720px, 94vw); max-width: 94vw; min-width: 0; max-height: 86vh; }
    .mrb-validate-report { overflow: auto; color: var(--jp-ui-font-color1); font-size: var(--jp-ui-font-size1); line-height: 1.45; }
    .mrb-validate-report p { margin: 4px 0; overflow-wrap: anywhere; }
    .mrb-validate-report h3 { margin: 14px 0 4px; font-size: var(--jp-ui-font-size2); }
    .mrb-validate-report ul { list-style: none; margin: 0; padding: 0; }
    .mrb-validate-report li { padding: 5px 0; border-top: 1px solid var(--jp-border-color2); }
    .mrb-validate-row { display: flex; flex-wrap: wrap; gap: 2px 8px; align-items: baseline; }
    .mrb-validate-title { flex: 1 1 240px; overflow-wrap: anywhere; }
    .mrb-validate-points { color: var(--jp-ui-font-color2); margin-left: calc(1em + 8px); }
    .mrb-validate-mark { font-weight: bold; width: 1em; }
    .mrb-validate-passed .mrb-validate-mark { color: var(--jp-success-color1); }
    .mrb-validate-failed .mrb-validate-mark, .mrb-validate-partial .mrb-validate-mark, .mrb-validate-bad { color: var(--jp-error-color1); }
    .mrb-validate-summary { font-weight: 600; font-size: var(--jp-ui-font-size2); }
    .mrb-validate-message, .mrb-validate-note { padding-left: calc(1em + 8px); }
    .mrb-validate-note { color: var(--jp-ui-font-color2); }
    .mrb-validate-report details { padding-left: calc(1em + 8px); color: var(--jp-ui-font-color2); }
    .mrb-validate-report pre { white-space: pre-wrap; overflow-wrap: anywhere; font-family: var(--jp-code-font-family); font-size: var(--jp-code-font-size); }
    .mrb-validate-report code { font-family: var(--jp-code-font-family); font-size: 0.95em; }
    .mrb-validate-picture { max-width: 100%; background: white; }
  `;

  async function makePlugin() {
    const names = ['@jupyterlab/apputils', '@jupyterlab/services', '@jupyterlab/coreutils', '@lumino/widgets'];
    const [apputils, services, coreutils, widgets] = await Promise.all(names.map(lab));
    const parts = { apputils, services, coreutils, widgets };
    const progress = await import(PROGRESS);
    const factory = {
      createNew(panel) {
        void panel.context.ready.then(() => wordsFor(panel, parts)).then(words => {
          if (panel.isDisposed) return;
          const button = new apputils.ToolbarButton({
            className: 'validate-button',
            label: 'Validate',
            tooltip: say(words, 'Run the visible checks of this lesson'),
            onClick: () => void validate(panel, button, words, parts)
          });
          // a narrow window hides the items at the right in a menu, behind three dots
          const isBefore = panel.toolbar.insertBefore('cellType', 'validate', button);
          if (!isBefore) panel.toolbar.insertBefore('spacer', 'validate', button);
        });
      }
    };
    return {
      id: `${NAME}:button`,
      description: 'Adds the Validate button to notebooks, and progress to the contents page.',
      autoStart: true,
      activate: app => {
        document.head.append(Object.assign(document.createElement('style'), { textContent: STYLE }));
        app.docRegistry.addWidgetExtension('Notebook', factory);
        app.docRegistry.addWidgetExtension('Notebook', progress.makeFactory(app, parts));
      }
    };
  }

  window._JUPYTERLAB = window._JUPYTERLAB || {};
  window._JUPYTERLAB[NAME] = {
    init: scope => {
      shared = scope;
    },
    get: async () => {
      const plugin = await makePlugin();
      return () => ({ __esModule: true, default: plugin });
    }
  };
})();
