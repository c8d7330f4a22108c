'use strict';
// The order of the page, and its light.

function startTheme() {
  const button = document.getElementById('theme');
  const prefersDark = window.matchMedia('(prefers-color-scheme: dark)');
  const show = (dark) => {
    document.documentElement.dataset.theme = dark ? 'dark' : 'light';
    button.setAttribute('aria-pressed', String(dark));
  };
  show(prefersDark.matches);
  prefersDark.addEventListener('change', (event) => show(event.matches));
  button.addEventListener('click', () => show(document.documentElement.dataset.theme !== 'dark'));
}

startTheme();
showVerdict();
showLadder();
showFindings();
showSpace();
showResiduals();
showWorkspace();
showParameters();
showWorst();
showDetectable();
drawCharts();
