(* SPDX-License-Identifier: BSD-3-Clause *)
(** * Witnesses: that two bodies have a point in common at one time

    As verify/contact.cpp. All models are looked at for s = 0, so what is certain is their number and remainder. *)
From Coq Require Import Reals ZArith Lia Lra Bool List.
From FclArtic Require Import Statement Numbers Trig Frames Enclose Reach Tube Leaf.
Import ListNotations.
Open Scope R_scope.

Lemma at_zero : Rabs 0 <= 1.
Proof. rewrite Rabs_R0. lra. Qed.

(** ** Every point of the world is one of each frame *)

Lemma steps_onto s sts E : holds_steps s sts E -> forall y, exists x, E x = y.
Proof.
  induction 1 as [E HE | st sts E M N HS HM IH HN]; intros y; [exists y; apply HE|].
  destruct (step_onto s st E HS y) as [z <-]. destruct (IH z) as [x <-]. exists x. apply HN.
Qed.

(** Distances stay what they are. *)

(** ** Numbers that are certain *)

Definition low (m : tm) : Z := (c0 m - rem m)%Z.
Definition high (m : tm) : Z := (c0 m + rem m)%Z.
Definition size (m : tm) : Z := (Z.abs (c0 m) + rem m)%Z.
Definition at_most (a b : tm) : bool := Z.leb (high a) (low b).
Definition sign_of (m : tm) : Z := if Z.ltb 0 (low m) then 1%Z else if Z.ltb (high m) 0 then (-1)%Z else 0%Z.

Lemma low_high m y : holds m 0 y -> V (low m) <= y <= V (high m).
Proof.
  unfold holds, poly, low, high. replace (V (c0 m) + V (c1 m) * 0 + V (c2 m) * (0 * 0)) with (V (c0 m)) by ring.
  intros H. apply abs_in in H. rewrite V_sub, V_add. lra.
Qed.
Lemma size_ok m y : holds m 0 y -> Rabs y <= V (size m).
Proof.
  intros H. apply low_high in H. unfold low, high, size in *. rewrite V_add, V_abs. rewrite V_sub, V_add in H.
  pose proof (Rle_abs (V (c0 m))). pose proof (Rle_abs (- V (c0 m))) as N. rewrite Rabs_Ropp in N. apply Rabs_le. lra.
Qed.
Lemma at_most_ok a b x y : at_most a b = true -> holds a 0 x -> holds b 0 y -> x <= y.
Proof. intros H A B. apply Z.leb_le, V_le in H. apply low_high in A, B. lra. Qed.
Lemma sign_of_ok m y : holds m 0 y -> (sign_of m = 1%Z -> 0 < y) /\ (sign_of m = (-1)%Z -> y < 0).
Proof.
  intros H. apply low_high in H. unfold sign_of.
  destruct (Z.ltb_spec 0 (low m)) as [P|_]; [apply V_lt in P; rewrite V_0 in P; split; [lra | discriminate]|].
  destruct (Z.ltb_spec (high m) 0) as [N|_]; [apply V_lt in N; rewrite V_0 in N; split; [discriminate | lra]|].
  split; discriminate.
Qed.

Lemma V_square a : V a * V a = IZR (a * a) * (ulp * ulp).
Proof. unfold V. rewrite mult_IZR. ring. Qed.

Lemma square_le x X : Rabs x <= V X -> x * x <= V X * V X.
Proof. intros H. apply abs_in in H. nra. Qed.

(** |v| <= r by integers. *)
Lemma in_radius v x y z R r : Rabs (vx v) <= V x -> Rabs (vy v) <= V y -> Rabs (vz v) <= V z ->
  (x * x + y * y + z * z <= R * R)%Z -> (0 <= R)%Z -> V R <= r -> norm v <= r.
Proof.
  intros Hx Hy Hz L R0 Hr. apply Rle_trans with (V R); [|exact Hr]. apply square_le in Hx, Hy, Hz.
  apply V_le in R0. rewrite V_0 in R0. rewrite <- (sqrt_square (V R)) by exact R0. apply sqrt_le_1_alt. unfold dot.
  rewrite !V_square in *. apply IZR_le in L. rewrite !plus_IZR in L. pose proof ulp_pos.
  assert (0 < ulp * ulp) by (apply Rmult_lt_0_compat; assumption). nra.
Qed.

(** ** Points in pieces *)

(** Weighted means of corners are in their hull. *)
Lemma mean_of_two cs x y a b : in_hull cs x -> in_hull cs y -> 0 <= a -> 0 <= b -> 0 < a + b ->
  in_hull cs (scale (/ (a + b)) (add (scale a x) (scale b y))).
Proof.
  intros X Y A B S. replace (scale (/ (a + b)) (add (scale a x) (scale b y))) with
    (add (scale (a / (a + b)) x) (scale (1 - a / (a + b)) y)).
  - apply between; [exact X | exact Y|]. split.
    + apply Rmult_le_pos; [exact A | left; apply Rinv_0_lt_compat; exact S].
    + apply Rmult_le_reg_r with (a + b); [exact S|]. unfold Rdiv. rewrite Rmult_assoc, Rinv_l by lra. lra.
  - destruct x as [x1 x2 x3], y as [y1 y2 y3]. unfold add, scale; cbn [vx vy vz]. f_equal; field; lra.
Qed.

Definition corners_of (g : geometry) (piece : nat) : option (list numbers3) :=
  match g with
  | MeshSurface ts => option_map (fun t => let '(a, b, c) := t in [a; b; c]) (nth_error ts piece)
  | Hull ps => Some ps
  | _ => None
  end.

Lemma corners_of_ok g piece ps x : corners_of g piece = Some ps -> in_hull (map point ps) x -> inside g x.
Proof.
  destruct g as [ts | | | | | | | | qs | |]; cbn [corners_of inside]; try discriminate.
  - destruct (nth_error ts piece) as [[[a b] c]|] eqn:N; [|discriminate]. intros [= <-] H. exists a, b, c.
    split; [exact (nth_error_In _ _ N) | exact H].
  - intros [= ->] H. exact H.
Qed.

(** The sum of weighted corners, and of the weights. *)
Fixpoint weighted (ps : list numbers3) (ws : list (nat * Z)) : option (tvec * Z) :=
  match ws with
  | [] => Some (origin_tm, 0%Z)
  | (k, x) :: rest =>
      match nth_error ps k, weighted ps rest with
      | Some p, Some (m, total) =>
          if Z.leb 0 x then Some (tadd (tscale (const (x * one) 0) (tm_point p)) m, (x + total)%Z) else None
      | _, _ => None
      end
  end.

Lemma weighted_ok ps ws : forall m total, weighted ps ws = Some (m, total) ->
  exists S, holdsv m 0 S /\ (0 <= total)%Z /\ (total = 0%Z -> S = Vec 0 0 0) /\
    ((0 < total)%Z -> in_hull (map point ps) (scale (/ IZR total) S)).
Proof.
  induction ws as [|[k x] rest IH]; intros m total; cbn [weighted].
  - intros [= <- <-]. exists (Vec 0 0 0). split; [apply origin_holds|]. split; [lia|]. split; [reflexivity | lia].
  - destruct (nth_error ps k) as [p|] eqn:N; [|discriminate].
    destruct (weighted ps rest) as [[m' t']|]; [|discriminate].
    destruct (Z.leb_spec 0 x) as [X|]; [|discriminate]. intros [= <- <-].
    destruct (IH m' t' eq_refl) as (S & HS & T0 & SZ & SH). exists (add (scale (IZR x) (point p)) S).
    assert (EX : V (x * one) = IZR x) by (unfold V; rewrite mult_IZR, Rmult_assoc, (Rmult_comm (IZR one)), ulp_one; ring).
    split; [|split; [lia|]].
    { apply holdsv_add; [|exact HS]. apply holdsv_scale; [apply at_zero | rewrite <- EX; apply holds_exact | apply holdsv_point]. }
    assert (IP : in_hull (map point ps) (point p)) by (apply corner, in_map; exact (nth_error_In _ _ N)).
    split.
    + intros E. assert (x = 0%Z) as -> by lia. assert (t' = 0%Z) as T by lia. rewrite (SZ T). destruct (point p) as [a b c].
      unfold add, scale; cbn [vx vy vz]. f_equal; ring.
    + intros P. destruct (Z.eq_dec t' 0) as [T|T].
      * rewrite T, (SZ T), Z.add_0_r. replace (scale (/ IZR x) _) with (point p); [exact IP|].
        assert (IZR x <> 0) by (apply not_0_IZR; lia). destruct (point p) as [a b c].
        unfold add, scale; cbn [vx vy vz]. f_equal; field; assumption.
      * assert (Tp : 0 < IZR t') by (apply IZR_lt; lia). assert (Xp : 0 <= IZR x) by (apply IZR_le; exact X).
        pose proof (mean_of_two _ _ _ (IZR x) (IZR t') IP (SH ltac:(lia)) Xp ltac:(lra) ltac:(lra)) as H.
        rewrite plus_IZR. replace (add (scale (IZR x) (point p)) S) with
          (add (scale (IZR x) (point p)) (scale (IZR t') (scale (/ IZR t') S))); [exact H|].
        f_equal. destruct S as [a b c]. unfold scale; cbn [vx vy vz]. f_equal; field; lra.
Qed.

Definition det (a b c : vec) : R := dot a (cross b c).
Definition tdet (a b c : tvec) : tm := tdot a (tcross b c).
Lemma tdet_ok a b c x y z : holdsv a 0 x -> holdsv b 0 y -> holdsv c 0 z -> holds (tdet a b c) 0 (det x y z).
Proof. intros. apply holds_dot; [apply at_zero | assumption | apply holdsv_cross; try apply at_zero; assumption]. Qed.
Lemma holdsv_sub a b x y : holdsv a 0 x -> holdsv b 0 y -> holdsv (tsub a b) 0 (sub x y).
Proof.
  intros (A & B & C) (D & E & F). unfold sub, add, scale.
  repeat split; cbn [tsub tx ty tz vx vy vz]; (eapply holds_eq; [|apply holds_sub; eassumption]; ring).
Qed.

(** The point x in the tetrahedron a, b, c, d: with each of the corners replaced by x its volume keeps its sign. *)
Definition volume (a b c d : tvec) : Z := sign_of (tdet (tsub b a) (tsub c a) (tsub d a)).
Definition in_tetrahedron (a b c d x : tvec) : bool :=
  let s := volume a b c d in
  negb (Z.eqb s 0) && Z.eqb (volume x b c d) s && Z.eqb (volume a x c d) s && Z.eqb (volume a b x d) s &&
  Z.eqb (volume a b c x) s.

Lemma volume_ok a b c d a' b' c' d' : holdsv a 0 a' -> holdsv b 0 b' -> holdsv c 0 c' -> holdsv d 0 d' ->
  let v := det (sub b' a') (sub c' a') (sub d' a') in
  (volume a b c d = 1%Z -> 0 < v) /\ (volume a b c d = (-1)%Z -> v < 0).
Proof. intros. apply sign_of_ok. apply tdet_ok; apply holdsv_sub; assumption. Qed.

Lemma sign_cases m : sign_of m = 1%Z \/ sign_of m = (-1)%Z \/ sign_of m = 0%Z.
Proof. unfold sign_of. destruct (Z.ltb 0 (low m)); [auto|]. destruct (Z.ltb (high m) 0); auto. Qed.

Lemma hull_of_four cs a b c d p q r s : in_hull cs a -> in_hull cs b -> in_hull cs c -> in_hull cs d ->
  0 < p -> 0 < q -> 0 < r -> 0 < s ->
  in_hull cs (scale (/ (p + q + r + s)) (add (add (add (scale p a) (scale q b)) (scale r c)) (scale s d))).
Proof.
  intros A B C D P Q R S.
  pose proof (mean_of_two _ _ _ p q A B ltac:(lra) ltac:(lra) ltac:(lra)) as H1.
  pose proof (mean_of_two _ _ _ (p + q) r H1 C ltac:(lra) ltac:(lra) ltac:(lra)) as H2.
  pose proof (mean_of_two _ _ _ (p + q + r) s H2 D ltac:(lra) ltac:(lra) ltac:(lra)) as H3.
  match type of H3 with in_hull _ ?x => match goal with |- in_hull _ ?y => replace y with x; [exact H3|] end end.
  destruct a as [a1 a2 a3], b as [b1 b2 b3], c as [e1 e2 e3], d as [d1 d2 d3]. unfold add, scale; cbn [vx vy vz].
  f_equal; field; lra.
Qed.

Lemma tetrahedron_ok cs a b c d x a' b' c' d' y : holdsv a 0 a' -> holdsv b 0 b' -> holdsv c 0 c' -> holdsv d 0 d' ->
  holdsv x 0 y -> in_tetrahedron a b c d x = true ->
  in_hull cs a' -> in_hull cs b' -> in_hull cs c' -> in_hull cs d' -> in_hull cs y.
Proof.
  intros Ha Hb Hc Hd Hx H A B C D. unfold in_tetrahedron in H. rewrite !andb_true_iff, !Z.eqb_eq, negb_true_iff, Z.eqb_neq in H.
  destruct H as [[[[NZ Ea] Eb] Ec] Ed].
  pose proof (volume_ok a b c d _ _ _ _ Ha Hb Hc Hd) as V0. pose proof (volume_ok x b c d _ _ _ _ Hx Hb Hc Hd) as Va.
  pose proof (volume_ok a x c d _ _ _ _ Ha Hx Hc Hd) as Vb. pose proof (volume_ok a b x d _ _ _ _ Ha Hb Hx Hd) as Vc.
  pose proof (volume_ok a b c x _ _ _ _ Ha Hb Hc Hx) as Vd. cbv zeta in *. rewrite Ea in Va. rewrite Eb in Vb. rewrite Ec in Vc. rewrite Ed in Vd.
  set (v := det (sub b' a') (sub c' a') (sub d' a')) in *. set (va := det (sub b' y) (sub c' y) (sub d' y)) in *.
  set (vb := det (sub y a') (sub c' a') (sub d' a')) in *. set (vc := det (sub b' a') (sub y a') (sub d' a')) in *.
  set (vd := det (sub b' a') (sub c' a') (sub y a')) in *.
  assert (SUM : va + vb + vc + vd = v).
  { unfold va, vb, vc, vd, v. destruct a' as [a1 a2 a3], b' as [b1 b2 b3], c' as [e1 e2 e3], d' as [d1 d2 d3], y as [y1 y2 y3].
    unfold det, dot, cross, sub, add, scale; cbn [vx vy vz]. ring. }
  assert (MEAN : scale v y = add (add (add (scale va a') (scale vb b')) (scale vc c')) (scale vd d')).
  { unfold va, vb, vc, vd, v. destruct a' as [a1 a2 a3], b' as [b1 b2 b3], c' as [e1 e2 e3], d' as [d1 d2 d3], y as [y1 y2 y3].
    unfold det, dot, cross, sub, add, scale; cbn [vx vy vz]. f_equal; ring. }
  assert (S : (0 < v /\ 0 < va /\ 0 < vb /\ 0 < vc /\ 0 < vd) \/ (v < 0 /\ va < 0 /\ vb < 0 /\ vc < 0 /\ vd < 0)).
  { unfold volume in *. destruct (sign_cases (tdet (tsub b a) (tsub c a) (tsub d a))) as [E|[E|E]]; [left | right | congruence].
    - repeat split; [apply V0 | apply Va | apply Vb | apply Vc | apply Vd]; exact E.
    - repeat split; [apply V0 | apply Va | apply Vb | apply Vc | apply Vd]; exact E. }
  destruct S as [(P & P1 & P2 & P3 & P4)|(P & P1 & P2 & P3 & P4)].
  - pose proof (hull_of_four cs _ _ _ _ va vb vc vd A B C D P1 P2 P3 P4) as H. rewrite SUM, <- MEAN in H.
    replace y with (scale (/ v) (scale v y)); [exact H|]. destruct y as [y1 y2 y3]. unfold scale; cbn [vx vy vz]. f_equal; field; lra.
  - pose proof (hull_of_four cs _ _ _ _ (- va) (- vb) (- vc) (- vd) A B C D ltac:(lra) ltac:(lra) ltac:(lra) ltac:(lra)) as H.
    replace (- va + - vb + - vc + - vd) with (- v) in H by lra.
    replace (add (add (add (scale (- va) a') (scale (- vb) b')) (scale (- vc) c')) (scale (- vd) d')) with
      (scale (-1) (scale v y)) in H.
    + replace y with (scale (/ - v) (scale (-1) (scale v y))); [exact H|]. destruct y as [y1 y2 y3].
      unfold scale; cbn [vx vy vz]. f_equal; field; lra.
    + rewrite MEAN. destruct a' as [a1 a2 a3], b' as [b1 b2 b3], c' as [e1 e2 e3], d' as [d1 d2 d3].
      unfold add, scale; cbn [vx vy vz]. f_equal; ring.
Qed.

(** Whether x is certainly in that piece of a shape; of a hull, in the tetrahedron of four of its points. *)
Definition within (x half : tm) : bool := Z.leb (size x) (low half).
Definition squares (x y z R : Z) : bool := Z.leb 0 R && Z.leb (x * x + y * y + z * z) (R * R).

Definition in_shape (g : geometry) (piece : nat) (four : list nat) (x : tvec) : bool :=
  let sx := size (tx x) in let sy := size (ty x) in let sz := size (tz x) in
  match g with
  | MeshSurface _ | Plane _ _ => false
  | Boxes cells =>
      match nth_error cells piece with
      | Some (c, h) =>
          let y := tsub x (tm_point c) in let k := tm_point h in
          within (tx y) (tx k) && within (ty y) (ty k) && within (tz y) (tz k)
      | None => false
      end
  | Box sizes => let k := tm_point (half3 sizes) in within (tx x) (tx k) && within (ty x) (ty k) && within (tz x) (tz k)
  | Sphere r => squares sx sy sz (number_down r)
  | Capsule r l =>
      let h := number_down (half l) in
      let z := Z.max (- h) (Z.min h (c0 (tz x))) in
      Z.leb 0 h && squares sx sy (Z.abs (c0 (tz x) - z) + rem (tz x)) (number_down r)
  | Ellipsoid a =>
      let p := number_down (n1 a) in let q := number_down (n2 a) in let r := number_down (n3 a) in
      Z.ltb 0 p && Z.ltb 0 q && Z.ltb 0 r && squares (sx * (q * r)) (sy * (p * r)) (sz * (p * q)) (p * (q * r))
  | Cylinder r l => Z.leb sz (number_down (half l)) && squares sx sy 0 (number_down r)
  | Cone r l =>                                           (* sqrt(x^2 + y^2) l <= r (l/2 - z) *)
      let h := number_down (half l) in
      Z.ltb 0 (number_down l) && Z.leb sz h && Z.leb 0 (number_down r) &&
      squares (sx * number_up l) (sy * number_up l) 0 (number_down r * (h - high (tz x)))
  | Hull ps =>
      match map (fun k => nth_error ps k) four with
      | [Some a; Some b; Some c; Some d] => in_tetrahedron (tm_point a) (tm_point b) (tm_point c) (tm_point d) x
      | _ => false
      end
  | Halfspace n d => at_most (tdot (tm_point n) x) (tm_number d)
  end.

Lemma within_ok m h x y : within m h = true -> holds m 0 x -> holds h 0 y -> Rabs x <= y.
Proof.
  intros H M K. apply Z.leb_le, V_le in H. apply size_ok in M. apply low_high in K. lra.
Qed.

Lemma V_mul_one a b : V a * V b = IZR (a * b) * (ulp * ulp).
Proof. unfold V. rewrite mult_IZR. ring. Qed.

Lemma squares_ok v x y z R r : Rabs (vx v) <= V x -> Rabs (vy v) <= V y -> Rabs (vz v) <= V z ->
  squares x y z R = true -> V R <= r -> norm v <= r.
Proof.
  unfold squares. rewrite andb_true_iff, !Z.leb_le. intros Hx Hy Hz [R0 L] Hr. exact (in_radius v x y z R r Hx Hy Hz L R0 Hr).
Qed.

Lemma in_shape_ok g piece four xm x : in_shape g piece four xm = true -> holdsv xm 0 x -> inside g x.
Proof.
  intros H Hx. pose proof Hx as (H1 & H2 & H3).
  pose proof (size_ok _ _ H1) as S1. pose proof (size_ok _ _ H2) as S2. pose proof (size_ok _ _ H3) as S3.
  destruct g as [ts | cells | sizes | r | r l | a | r l | r l | ps | n d | n d]; cbn [in_shape inside] in *; try discriminate.
  - destruct (nth_error cells piece) as [[c h]|] eqn:N; [|discriminate]. rewrite !andb_true_iff in H.
    destruct H as [[W1 W2] W3]. exists c, h. split; [exact (nth_error_In _ _ N)|].
    pose proof (holdsv_sub _ _ _ _ Hx (holdsv_point 0 c)) as (K1 & K2 & K3).
    split; [exact (within_ok _ _ _ _ W1 K1 (holds_number 0 _))|].
    split; [exact (within_ok _ _ _ _ W2 K2 (holds_number 0 _)) | exact (within_ok _ _ _ _ W3 K3 (holds_number 0 _))].
  - rewrite !andb_true_iff in H. destruct H as [[W1 W2] W3].
    assert (K : holdsv (tm_point (half3 sizes)) 0 (scale (/ 2) (point sizes))).
    { replace (scale (/ 2) (point sizes)) with (point (half3 sizes)); [apply holdsv_point|].
      unfold point, half3, scale; cbn [vx vy vz n1 n2 n3]. rewrite !real_half. f_equal; field. }
    destruct K as (K1 & K2 & K3). split; [exact (within_ok _ _ _ _ W1 H1 K1)|].
    split; [exact (within_ok _ _ _ _ W2 H2 K2) | exact (within_ok _ _ _ _ W3 H3 K3)].
  - exact (squares_ok x _ _ _ _ _ S1 S2 S3 H (number_down_ok r)).
  - rewrite andb_true_iff, Z.leb_le in H. destruct H as [H0 H]. set (h := number_down (half l)) in *.
    set (z := Z.max (- h) (Z.min h (c0 (tz xm)))) in *. exists (V z).
    pose proof (number_down_ok (half l)) as L. rewrite real_half in L. fold h in L.
    assert (Z1 : V (- h) <= V z) by (apply V_le; unfold z; lia). rewrite V_opp in Z1.
    assert (Z2 : V z <= V h) by (apply V_le; unfold z; lia).
    split; [lra|]. eapply squares_ok; [| | | exact H | apply number_down_ok]; unfold sub, add, scale; cbn [vx vy vz].
    + replace (vx x + -1 * 0) with (vx x) by ring. exact S1.
    + replace (vy x + -1 * 0) with (vy x) by ring. exact S2.
    + unfold holds, poly in H3. replace (V (c0 (tz xm)) + V (c1 (tz xm)) * 0 + V (c2 (tz xm)) * (0 * 0)) with (V (c0 (tz xm))) in H3 by ring.
      rewrite V_add, V_abs, V_sub. replace (vz x + -1 * V z) with ((V (c0 (tz xm)) - V z) + (vz x - V (c0 (tz xm)))) by ring.
      eapply Rle_trans; [apply Rabs_triang|]. lra.
  - rewrite !andb_true_iff, !Z.ltb_lt in H. destruct H as [[[P Q] Rp] H].
    set (p := number_down (n1 a)) in *. set (q := number_down (n2 a)) in *. set (r := number_down (n3 a)) in *.
    pose proof (number_down_ok (n1 a)) as A1. pose proof (number_down_ok (n2 a)) as A2. pose proof (number_down_ok (n3 a)) as A3.
    fold p in A1. fold q in A2. fold r in A3.
    pose proof (V_lt _ _ P) as P'. pose proof (V_lt _ _ Q) as Q'. pose proof (V_lt _ _ Rp) as R'. rewrite V_0 in P', Q', R'.
    exists (Vec (vx x / real (n1 a)) (vy x / real (n2 a)) (vz x / real (n3 a))). split.
    + unfold squares in H. rewrite andb_true_iff, !Z.leb_le in H. destruct H as [_ H]. apply IZR_le in H.
      rewrite !plus_IZR, !mult_IZR in H.
      assert (U : forall y s b e, Rabs y <= V s -> (0 < b)%Z -> V b <= e ->
        y / e * (y / e) <= IZR s / IZR b * (IZR s / IZR b)).
      { intros y s b e Hy Hb He. pose proof (V_lt _ _ Hb) as Hb'. rewrite V_0 in Hb'. pose proof (IZR_lt _ _ Hb) as Hb''.
        assert (K : Rabs (y / e) <= IZR s / IZR b).
        { unfold Rdiv. rewrite Rabs_mult, (Rabs_right (/ e)) by (left; apply Rinv_0_lt_compat; lra).
          apply Rmult_le_reg_r with e; [lra|]. rewrite Rmult_assoc, Rinv_l, Rmult_1_r by lra.
          eapply Rle_trans; [exact Hy|]. 
          assert (N0 : 0 <= V s) by (eapply Rle_trans; [apply Rabs_pos | exact Hy]).
          assert (N1 : 0 <= IZR s). { unfold V in N0. pose proof ulp_pos. nra. }
          replace (V s) with (IZR s * / IZR b * V b) by (unfold V; field; lra).
          apply Rmult_le_compat_l; [|exact He]. apply Rmult_le_pos; [exact N1 | left; apply Rinv_0_lt_compat; exact Hb'']. }
        apply abs_in in K. nra. }
      pose proof (U _ _ _ _ S1 P A1) as U1. pose proof (U _ _ _ _ S2 Q A2) as U2. pose proof (U _ _ _ _ S3 Rp A3) as U3.
      apply IZR_lt in P, Q, Rp.
      rewrite <- sqrt_1. apply sqrt_le_1_alt. unfold dot; cbn [vx vy vz].
      eapply Rle_trans; [apply Rplus_le_compat; [apply Rplus_le_compat; [exact U1 | exact U2] | exact U3]|].
      set (e := IZR (size (tx xm))) in *. set (f := IZR (size (ty xm))) in *. set (g := IZR (size (tz xm))) in *.
      set (p' := IZR p) in *. set (q' := IZR q) in *. set (r' := IZR r) in *.
      assert (PP : 0 < p' * (q' * r')) by (repeat apply Rmult_lt_0_compat; assumption).
      apply Rmult_le_reg_r with (p' * (q' * r') * (p' * (q' * r'))); [apply Rmult_lt_0_compat; exact PP|].
      match goal with |- ?l <= ?rr => replace l with
        (e * (q' * r') * (e * (q' * r')) + f * (p' * r') * (f * (p' * r')) + g * (p' * q') * (g * (p' * q')))
        by (field; repeat split; lra) end. lra.
    + cbn [vx vy vz]. destruct x as [x1 x2 x3]; cbn [vx vy vz]. f_equal; field; lra.
  - rewrite andb_true_iff, Z.leb_le in H. destruct H as [L H]. apply V_le in L.
    pose proof (number_down_ok (half l)) as B. rewrite real_half in B. split.
    + eapply squares_ok; [exact S1 | exact S2 | | exact H | apply number_down_ok]. cbn [vz]. rewrite Rabs_R0, V_0. lra.
    + apply abs_in in S3. lra.
  - rewrite !andb_true_iff, !Z.leb_le, Z.ltb_lt in H. destruct H as [[[Lp L] R0] H].
    set (h := number_down (half l)) in *. pose proof (number_down_ok (half l)) as B. rewrite real_half in B. fold h in B.
    pose proof (number_down_ok l) as Ll. pose proof (number_up_ok l) as Lu. pose proof (V_lt _ _ Lp) as Lp'. rewrite V_0 in Lp'.
    pose proof (V_le _ _ L) as L'. pose proof (abs_in _ _ S3) as S3'. pose proof (low_high _ _ H3) as [_ HZ].
    set (D := (h - high (tz xm))%Z) in *.
    assert (D0 : (0 <= D)%Z) by (unfold D, high, size in *; lia).
    assert (HD : V D <= real l / 2 - vz x) by (unfold D; rewrite V_sub; lra).
    pose proof (number_down_ok r) as Hr. apply V_le in R0, D0. rewrite V_0 in R0, D0.
    set (n := norm (Vec (vx x) (vy x) 0)).
    assert (N0 : 0 <= n) by apply norm_nonneg.
    assert (K : n * V (number_up l) <= V (number_down r) * V D).
    { unfold squares in H. rewrite andb_true_iff, !Z.leb_le in H. destruct H as [_ H]. apply IZR_le in H.
      apply Rsqr_incr_0_var; [|apply Rmult_le_pos; assumption]. unfold Rsqr.
      assert (NN : n * n = vx x * vx x + vy x * vy x).
      { unfold n, norm. rewrite sqrt_sqrt by apply dot_nonneg. unfold dot; cbn [vx vy vz]. ring. }
      replace (n * V (number_up l) * (n * V (number_up l))) with (n * n * (V (number_up l) * V (number_up l))) by ring.
      rewrite NN. pose proof (square_le _ _ S1) as Q1. pose proof (square_le _ _ S2) as Q2.
      eapply Rle_trans; [apply Rmult_le_compat_r; [apply Rle_0_sqr | apply Rplus_le_compat; [exact Q1 | exact Q2]]|].
      unfold V. rewrite !plus_IZR, !mult_IZR in H. pose proof ulp_pos as U0. set (u := ulp) in *.
      set (e := IZR (size (tx xm))) in *. set (f := IZR (size (ty xm))) in *. set (lu := IZR (number_up l)) in *.
      set (rr := IZR (number_down r)) in *. set (dd := IZR D) in *.
      replace ((e * u * (e * u) + f * u * (f * u)) * (lu * u * (lu * u))) with
        ((e * lu * (e * lu) + f * lu * (f * lu)) * (u * u * (u * u))) by ring.
      replace (rr * u * (dd * u) * (rr * u * (dd * u))) with (rr * dd * (rr * dd) * (u * u * (u * u))) by ring.
      apply Rmult_le_compat_r; [apply Rmult_le_pos; apply Rle_0_sqr | lra]. }
    exists ((vz x + real l / 2) / real l).
    assert (L0 : 0 < real l) by lra. split; [|split].
    + split; apply Rmult_le_reg_r with (real l); try exact L0; unfold Rdiv; rewrite Rmult_assoc, Rinv_l by lra; lra.
    + fold n. replace (1 - (vz x + real l / 2) / real l) with ((real l / 2 - vz x) / real l) by (field; lra).
      apply Rmult_le_reg_r with (real l); [exact L0|].
      replace ((real l / 2 - vz x) / real l * real r * real l) with (real r * (real l / 2 - vz x)) by (field; lra).
      apply Rle_trans with (n * V (number_up l)); [apply Rmult_le_compat_l; assumption|].
      eapply Rle_trans; [exact K|]. apply Rmult_le_compat; assumption.
    + field. lra.
  - destruct (map (fun k => nth_error ps k) four) as [|[a|] [|[b|] [|[c|] [|[d|] [|]]]]] eqn:E; try discriminate.
    assert (I : forall y, In (Some y) (map (fun k => nth_error ps k) four) -> in_hull (map point ps) (point y)).
    { intros y Iy. apply in_map_iff in Iy. destruct Iy as (k & N & _). apply corner, in_map. exact (nth_error_In _ _ N). }
    rewrite E in I.
    eapply (tetrahedron_ok _ (tm_point a) (tm_point b) (tm_point c) (tm_point d));
      [apply holdsv_point | apply holdsv_point | apply holdsv_point | apply holdsv_point | exact Hx | exact H | | | |];
      apply I; cbn [In]; auto 6.
  - eapply at_most_ok; [exact H | apply holds_dot; [apply at_zero | apply holdsv_point | exact Hx] | apply holds_number].
Qed.

(** ** Where a body's points are in another's coordinates *)

Definition units : list tvec :=
  [Tvec tm_one tm_zero tm_zero; Tvec tm_zero tm_one tm_zero; Tvec tm_zero tm_zero tm_one].

Definition coordinate (fs : tree) (A B : sbody) (n : tvec) : option func :=
  let known := chain (length fs) fs (sb_frame B) (up (sb_place B) (Func n tm_zero)) in
  option_map (down (sb_place A)) (at_frame (length fs) fs known (sb_frame A)).
Definition on (f : func) (x : tvec) : tm := tm_add (tdot (fv f) x) (fd f).

(** The edge pq crosses the triangle: p and q are on different sides of its plane, and pq passes all edges on one side. *)
Definition crosses (p q a b c : tvec) : bool :=
  let e := tsub q p in let a := tsub a p in let b := tsub b p in let c := tsub c p in
  let s := sign_of (tdet e a b) in
  Z.eqb (sign_of (tdet a b c) * sign_of (tdet (tsub a e) (tsub b e) (tsub c e))) (-1) &&
  negb (Z.eqb s 0) && Z.eqb (sign_of (tdet e b c)) s && Z.eqb (sign_of (tdet e c a)) s.

Lemma crosses_ok p q a b c p' q' a' b' c' : holdsv p 0 p' -> holdsv q 0 q' -> holdsv a 0 a' -> holdsv b 0 b' ->
  holdsv c 0 c' -> crosses p q a b c = true ->
  exists l, 0 <= l <= 1 /\ in_hull [a'; b'; c'] (add (scale l q') (scale (1 - l) p')).
Proof.
  intros Hp Hq Ha Hb Hc H. unfold crosses in H. rewrite !andb_true_iff, !Z.eqb_eq, negb_true_iff, Z.eqb_neq in H.
  destruct H as [[[SS NZ] E1] E2].
  pose proof (holdsv_sub _ _ _ _ Hq Hp) as He. pose proof (holdsv_sub _ _ _ _ Ha Hp) as Ka.
  pose proof (holdsv_sub _ _ _ _ Hb Hp) as Kb. pose proof (holdsv_sub _ _ _ _ Hc Hp) as Kc.
  pose proof (sign_of_ok _ _ (tdet_ok _ _ _ _ _ _ Ka Kb Kc)) as D. 
  pose proof (sign_of_ok _ _ (tdet_ok _ _ _ _ _ _ (holdsv_sub _ _ _ _ Ka He) (holdsv_sub _ _ _ _ Kb He) (holdsv_sub _ _ _ _ Kc He))) as D'.
  pose proof (sign_of_ok _ _ (tdet_ok _ _ _ _ _ _ He Ka Kb)) as S0. pose proof (sign_of_ok _ _ (tdet_ok _ _ _ _ _ _ He Kb Kc)) as S1.
  pose proof (sign_of_ok _ _ (tdet_ok _ _ _ _ _ _ He Kc Ka)) as S2. rewrite E1 in S1. rewrite E2 in S2.
  set (e := sub q' p') in *. set (u := sub a' p') in *. set (v := sub b' p') in *. set (x := sub c' p') in *.
  set (d := det u v x) in *. set (d' := det (sub u e) (sub v e) (sub x e)) in *.
  set (s0 := det e u v) in *. set (s1 := det e v x) in *. set (s2 := det e x u) in *.
  assert (SUM : d - d' = s0 + s1 + s2).
  { unfold d, d', s0, s1, s2. destruct e as [e1 e2 e3], u as [u1 u2 u3], v as [v1 v2 v3], x as [x1 x2 x3].
    unfold det, dot, cross, sub, add, scale; cbn [vx vy vz]. ring. }
  assert (MEAN : scale (s0 + s1 + s2) p' = sub (add (add (scale s1 a') (scale s2 b')) (scale s0 c')) (scale d e)).
  { unfold d, s0, s1, s2, e, u, v, x. destruct p' as [p1 p2 p3], q' as [q1 q2 q3], a' as [a1 a2 a3], b' as [b1 b2 b3], c' as [c1' c2' c3'].
    unfold det, dot, cross, sub, add, scale; cbn [vx vy vz]. f_equal; ring. }
  assert (POINT : forall k, k <> 0 -> s0 + s1 + s2 <> 0 -> add (scale (d / (s0 + s1 + s2)) q') (scale (1 - d / (s0 + s1 + s2)) p') =
    scale (/ (k * s1 + k * s2 + k * s0)) (add (scale (k * s1 + k * s2) (scale (/ (k * s1 + k * s2)) (add (scale (k * s1) a') (scale (k * s2) b'))))
      (scale (k * s0) c')) \/ k * s1 + k * s2 = 0).
  { intros k K N. destruct (Req_dec (k * s1 + k * s2) 0) as [Q|Q]; [right; exact Q | left].
    assert (T : k * s1 + k * s2 + k * s0 <> 0) by (replace (k * s1 + k * s2 + k * s0) with (k * (s0 + s1 + s2)) by ring; apply Rmult_integral_contrapositive; auto).
    assert (PP : p' = scale (/ (s0 + s1 + s2)) (sub (add (add (scale s1 a') (scale s2 b')) (scale s0 c')) (scale d e))).
    { rewrite <- MEAN. destruct p' as [p1 p2 p3]. unfold scale; cbn [vx vy vz]. f_equal; field; exact N. }
    assert (QQ : q' = add p' e).
    { unfold e. destruct p' as [p1 p2 p3], q' as [q1 q2 q3]. unfold add, sub, scale, add; cbn [vx vy vz]. f_equal; ring. }
    transitivity (add p' (scale (d / (s0 + s1 + s2)) e)).
    - rewrite QQ. destruct p' as [p1 p2 p3], e as [e1 e2 e3]. unfold add, scale; cbn [vx vy vz]. f_equal; ring.
    - rewrite PP. clear - N Q T K. clearbody e d s0 s1 s2. destruct a' as [a1 a2 a3], b' as [b1 b2 b3], c' as [c1' c2' c3'], e as [e1 e2 e3].
      unfold add, sub, scale, add; cbn [vx vy vz].
      assert (Q' : s1 + s2 <> 0) by (intros Z0; apply Q; replace (k * s1 + k * s2) with (k * (s1 + s2)) by ring; rewrite Z0; ring).
      f_equal; field; repeat split; try assumption; lra. }
  assert (IN : forall k, 0 < k * s0 -> 0 < k * s1 -> 0 < k * s2 ->
    in_hull [a'; b'; c'] (add (scale (d / (s0 + s1 + s2)) q') (scale (1 - d / (s0 + s1 + s2)) p'))).
  { intros k K0 K1 K2. assert (KN : k <> 0) by (intros ->; lra).
    assert (SN : s0 + s1 + s2 <> 0) by (intros Z0; assert (k * (s0 + s1 + s2) = 0) by (rewrite Z0; ring); lra).
    destruct (POINT k KN SN) as [->|Q]; [|lra].
    apply mean_of_two; try lra; [|apply corner; cbn; auto].
    apply mean_of_two; try lra; apply corner; cbn; auto. }
  exists (d / (s0 + s1 + s2)).
  destruct (sign_cases (tdet (tsub a p) (tsub b p) (tsub c p))) as [G|[G|G]]; rewrite G in SS;
    destruct (sign_cases (tdet (tsub (tsub a p) (tsub q p)) (tsub (tsub b p) (tsub q p)) (tsub (tsub c p) (tsub q p)))) as [G'|[G'|G']];
    rewrite G' in SS; try discriminate SS.
  - pose proof (proj1 D G). pose proof (proj2 D' G').
    destruct (sign_cases (tdet (tsub q p) (tsub a p) (tsub b p))) as [T|[T|T]]; [| |congruence].
    + split; [|apply (IN 1); [pose proof (proj1 S0 T) | pose proof (proj1 S1 T) | pose proof (proj1 S2 T)]; lra].
      rewrite <- SUM. split; apply Rmult_le_reg_r with (d - d'); try lra; unfold Rdiv; rewrite Rmult_assoc, Rinv_l by lra; lra.
    + pose proof (proj2 S0 T). pose proof (proj2 S1 T). pose proof (proj2 S2 T). lra.
  - pose proof (proj2 D G). pose proof (proj1 D' G').
    destruct (sign_cases (tdet (tsub q p) (tsub a p) (tsub b p))) as [T|[T|T]]; [| |congruence].
    + pose proof (proj1 S0 T). pose proof (proj1 S1 T). pose proof (proj1 S2 T). lra.
    + split; [|apply (IN (-1)); [pose proof (proj2 S0 T) | pose proof (proj2 S1 T) | pose proof (proj2 S2 T)]; lra].
      replace (d / (s0 + s1 + s2)) with (- d / (d' - d)) by (rewrite <- SUM; field; lra).
      split; apply Rmult_le_reg_r with (d' - d); try lra; unfold Rdiv; rewrite Rmult_assoc, Rinv_l by lra; lra.
Qed.

(** ** The witness *)

(** A point of a body: a weighted mean of corners of a triangle or hull, or numbers that are in a shape. *)
Inductive place_of :=
  | Mean (piece : nat) (weights : list (nat * Z))
  | Given (piece : nat) (p : numbers3).

Inductive witness :=
  | Cross (piece edge crossed : nat)                      (* an edge of the one's triangle, a triangle of the other *)
  | Inside (p : place_of) (container : nat) (four : list nat)
  | Near (p q : place_of).                                (* points of the one and the other *)

Definition only_near (x : witness) : bool := match x with Near _ _ => true | _ => false end.

Definition point_of (g : geometry) (p : place_of) : option tvec :=
  match p with
  | Mean piece ws =>
      match corners_of g piece with
      | Some ps =>
          match weighted ps ws with
          | Some (m, total) =>
              if Z.ltb 0 total then Some (Tvec (tm_div (tx m) total) (tm_div (ty m) total) (tm_div (tz m) total)) else None
          | None => None
          end
      | None => None
      end
  | Given piece x => if in_shape g piece [] (tm_point x) then Some (tm_point x) else None
  end.

Lemma point_of_ok g p m : point_of g p = Some m -> exists x, holdsv m 0 x /\ inside g x.
Proof.
  destruct p as [piece ws | piece x]; cbn [point_of].
  - destruct (corners_of g piece) as [ps|] eqn:C; [|discriminate].
    destruct (weighted ps ws) as [[s total]|] eqn:W; [|discriminate].
    destruct (Z.ltb_spec 0 total) as [T|]; [|discriminate]. intros [= <-].
    destruct (weighted_ok ps ws _ _ W) as (S & (A & B & D) & _ & _ & H). exists (scale (/ IZR total) S).
    split; [|exact (corners_of_ok g piece ps _ C (H T))].
    unfold scale. repeat split; cbn [tx ty tz vx vy vz]; rewrite Rmult_comm; apply holds_div; try exact T; try apply at_zero; assumption.
  - destruct (in_shape g piece [] (tm_point x)) eqn:I; [|discriminate]. intros [= <-]. exists (point x).
    split; [apply holdsv_point|]. exact (in_shape_ok _ _ _ _ _ I (holdsv_point 0 x)).
Qed.

Definition edge_of {T} (edge : nat) (a b c : T) : T * T :=
  match edge with O => (a, b) | 1%nat => (b, c) | _ => (c, a) end.

(** Whether the witness shows that A and B meet, where [row] takes a coordinate of B to A. *)
Definition shows (A B : geometry) (rx ry rz : func) (margin : Z) (x : witness) : bool :=
  let take p := Tvec (on rx p) (on ry p) (on rz p) in
  match x with
  | Cross piece edge crossed =>
      match corners_of A piece, corners_of B crossed with
      | Some [a; b; c], Some [d; e; f] =>
          let '(p, q) := edge_of edge a b c in
          crosses (take (tm_point p)) (take (tm_point q)) (tm_point d) (tm_point e) (tm_point f)
      | _, _ => false
      end
  | Inside p container four =>
      match point_of A p with Some m => in_shape B container four (take m) | None => false end
  | Near p q =>
      match point_of A p, point_of B q with
      | Some m, Some n =>
          let d := tsub (take m) n in squares (size (tx d)) (size (ty d)) (size (tz d)) margin
      | _, _ => false
      end
  end.

Definition sbody_of (b : body) : sbody := Sbody (body_frame b) (placed (body_place b)) None.

(** A pair's margin, each number of it rounded by [round]. *)
Definition rounded_margin (round : number -> Z) (w : world) (m : motion) (a b : body) : Z :=
  (round (added_margin m) +
   match pair_margin w a b, own_margin w a, own_margin w b with
   | Some x, _, _ => round x
   | None, Some x, Some y => Z.max (round x) (round y)
   | None, Some x, None => round x
   | None, None, Some y => round y
   | None, None, None => round (general_margin m)
   end)%Z.
Definition margin_down := rounded_margin number_down.

Lemma margin_down_ok w m a b : V (margin_down w m a b) <= margin w m a b.
Proof.
  unfold margin, margin_down, rounded_margin. rewrite V_add. apply Rplus_le_compat; [apply number_down_ok|].
  destruct (pair_margin w a b); [apply number_down_ok|].
  destruct (own_margin w a) as [x|], (own_margin w b) as [y|]; try apply number_down_ok.
  pose proof (number_down_ok x). pose proof (number_down_ok y).
  pose proof (Rmax_l (real x) (real y)). pose proof (Rmax_r (real x) (real y)).
  destruct (Z.max_spec (number_down x) (number_down y)) as [[_ ->]|[_ ->]]; lra.
Qed.

Definition meet_at (sfs : list sframe) (x : sstate) (a b : body) (margin : Z) (wt : witness) : bool :=
  let fs := tree_of sfs x in
  match map (coordinate fs (sbody_of a) (sbody_of b)) units with
  | [Some rx; Some ry; Some rz] => shows (body_geometry a) (body_geometry b) rx ry rz margin wt
  | _ => false
  end.

(** [first]: the witness is about a point of body i, which is one of body j; else the other way round. *)
Definition meets_ok (w : world) (m : motion) (k i j : nat) (t : number) (first : bool) (wt : witness) : bool :=
  match nth_error (pieces m) k, nth_error (bodies w) i, nth_error (bodies w) j with
  | Some p, Some a, Some b =>
      Nat.ltb i j && checked w m a b && Z.leb 0 (mantissa t) && Z.leb (number_up t) one &&
      forallb (fun e => let '(g, h, u) := e in
                 negb (Nat.eqb g i && Nat.eqb h j) || Z.ltb (number_up u) (number_down t)) (ignored p) &&
      let sfs := map sframe_of (frames w) in
      let x := state_at (spiece_of p) (tm_number t) in
      let d := margin_down w m a b in
      if first then meet_at sfs x a b d wt else meet_at sfs x b a d wt
  | _, _, _ => false
  end.

Section Meets.
Variable w : world.
Hypothesis WF : well_formed w.
Variable pc : piece.
Variable t : R.
Variable tmodel : tm.
Hypothesis Ht : holds tmodel 0 t.
Variables P P' : nat -> vec -> vec.
Hypothesis HP : frames_at w (at_time pc t) P P'.
Let fs := tree_of (map sframe_of (frames w)) (state_at (spiece_of pc) tmodel).

Lemma child_ok i k sts : nth_error fs i = Some (k, sts) -> exists E, holds_steps 0 sts E /\ forall x, P (S i) x = P k (E x).
Proof. exact (tree_ok w pc tmodel t 0 P P' at_zero Ht HP i k sts). Qed.

Lemma parents_before k p sts : nth_error fs k = Some (p, sts) -> (p <= k)%nat.
Proof.
  unfold fs, tree_of. rewrite map_map, nth_error_map. destruct (nth_error (frames w) k) as [f|] eqn:N; [|discriminate].
  cbn. intros [= <- _]. apply (proj1 WF). exact N.
Qed.
Lemma fs_length : length fs = length (frames w).
Proof. unfold fs, tree_of. rewrite !map_length. reflexivity. Qed.

Lemma frame_onto n : forall i, (i <= n)%nat -> (i <= length (frames w))%nat -> forall y, exists x, P i x = y.
Proof.
  induction n as [|n IH]; intros i Hi Hl y.
  - assert (i = O) as -> by lia. exists y. apply (proj1 HP).
  - destruct i as [|k]; [exists y; apply (proj1 HP)|].
    destruct (nth_error fs k) as [[p sts]|] eqn:N; [|apply nth_error_None in N; rewrite fs_length in N; lia].
    pose proof (parents_before _ _ _ N) as Hp. destruct (child_ok _ _ _ N) as (E & HE & X).
    destruct (IH p ltac:(lia) ltac:(lia) y) as [z <-]. destruct (steps_onto 0 sts E HE z) as [x <-]. exists x. apply X.
Qed.

Lemma frame_keeps n : forall i, (i <= n)%nat -> (i <= length (frames w))%nat -> forall x y,
  norm (sub (P i x) (P i y)) = norm (sub x y).
Proof.
  induction n as [|n IH]; intros i Hi Hl x y.
  - assert (i = O) as -> by lia. rewrite !(proj1 HP). reflexivity.
  - destruct i as [|k]; [rewrite !(proj1 HP); reflexivity|].
    destruct (nth_error fs k) as [[p sts]|] eqn:N; [|apply nth_error_None in N; rewrite fs_length in N; lia].
    pose proof (parents_before _ _ _ N) as Hp. destruct (child_ok _ _ _ N) as (E & HE & X).
    rewrite !X, (IH p) by lia. apply (steps_keep 0 sts E HE).
Qed.

Variables A B : sbody.
Variables F G : vec -> vec.
Hypothesis HF : holds_step 0 (sb_place A) F.
Hypothesis HG : holds_step 0 (sb_place B) G.
Hypothesis InB : (sb_frame B <= length (frames w))%nat.

Lemma coordinate_ok nm n f : holdsv nm 0 n -> coordinate fs A B nm = Some f ->
  exists v d u e, holdsf 0 f v d /\ (forall x, dot u (P (sb_frame A) (F x)) + e = dot v x + d) /\
    forall y, dot u (P (sb_frame B) (G y)) + e = dot n y.
Proof.
  intros Hn. unfold coordinate. set (g := Func nm tm_zero).
  assert (Hg : holdsf 0 g n 0) by (split; [exact Hn | apply holds_zero]).
  destruct (up_ok 0 at_zero _ G g n 0 HG Hg) as (v1 & d1 & H1 & _ & X1).
  destruct (chain_ok 0 at_zero fs P (proj1 HP) child_ok (length fs) (sb_frame B) _ v1 d1 parents_before
    ltac:(rewrite fs_length; exact InB) ltac:(rewrite fs_length; exact InB) H1) as (u & e & _ & Xu & K).
  destruct (at_frame (length fs) fs _ (sb_frame A)) as [h|] eqn:EA; [|discriminate]. intros [= <-].
  pose proof (at_frame_ok 0 at_zero fs P child_ok (length fs) u e _ K _ h EA) as IA.
  destruct (body_ok 0 at_zero P u e _ h _ F IA HF) as (v & d & Hv & _ & X).
  exists v, d, u, e. split; [exact Hv|]. split; [exact X|]. intros y. rewrite Xu, X1. ring.
Qed.

(** Points of A's geometry in the coordinates of B's. *)
Lemma taken_ok rx ry rz : map (coordinate fs A B) units = [Some rx; Some ry; Some rz] ->
  exists M, (forall m x, holdsv m 0 x -> holdsv (Tvec (on rx m) (on ry m) (on rz m)) 0 (M x)) /\
    (forall x, P (sb_frame B) (G (M x)) = P (sb_frame A) (F x)) /\
    forall x y l, M (add (scale l x) (scale (1 - l) y)) = add (scale l (M x)) (scale (1 - l) (M y)).
Proof.
  unfold units. cbn [map]. intros E. injection E as Ex Ey Ez.
  assert (U1 : holdsv (Tvec tm_one tm_zero tm_zero) 0 (Vec 1 0 0)) by (repeat split; cbn; try apply holds_zero; apply holds_one).
  assert (U2 : holdsv (Tvec tm_zero tm_one tm_zero) 0 (Vec 0 1 0)) by (repeat split; cbn; try apply holds_zero; apply holds_one).
  assert (U3 : holdsv (Tvec tm_zero tm_zero tm_one) 0 (Vec 0 0 1)) by (repeat split; cbn; try apply holds_zero; apply holds_one).
  destruct (coordinate_ok _ _ _ U1 Ex) as (v1 & d1 & u1 & e1 & [V1 D1] & X1 & Y1).
  destruct (coordinate_ok _ _ _ U2 Ey) as (v2 & d2 & u2 & e2 & [V2 D2] & X2 & Y2).
  destruct (coordinate_ok _ _ _ U3 Ez) as (v3 & d3 & u3 & e3 & [V3 D3] & X3 & Y3).
  exists (fun x => Vec (dot v1 x + d1) (dot v2 x + d2) (dot v3 x + d3)). split; [|split].
  - intros m x Hx. repeat split; cbn [tx ty tz vx vy vz]; unfold on; (apply holds_add; [apply holds_dot; [apply at_zero | |] |]; assumption).
  - intros x. destruct (frame_onto (sb_frame B) (sb_frame B) (le_n _) InB (P (sb_frame A) (F x))) as [z Ez'].
    destruct (step_onto 0 _ G HG z) as [y <-]. rewrite <- Ez'. f_equal. f_equal.
    rewrite <- X1, <- X2, <- X3, <- Ez', Y1, Y2, Y3. destruct y as [y1 y2 y3]. unfold dot; cbn [vx vy vz]. f_equal; ring.
  - intros x y l. unfold add, scale, dot; cbn [vx vy vz]. f_equal; ring.
Qed.
End Meets.

Lemma meet_at_ok w pc t tmodel P P' a b F G d wt : well_formed w -> (body_frame b <= length (frames w))%nat ->
  holds tmodel 0 t -> frames_at w (at_time pc t) P P' -> pose_map (body_place a) F -> pose_map (body_place b) G ->
  meet_at (map sframe_of (frames w)) (state_at (spiece_of pc) tmodel) a b d wt = true ->
  exists x y, occupies P a F x /\ occupies P b G y /\ if only_near wt then norm (sub x y) <= V d else x = y.
Proof.
  intros WF Hb Ht HP HF HG H. unfold meet_at in H.
  destruct (map _ units) as [|[rx|] [|[ry|] [|[rz|] [|]]]] eqn:R; try discriminate.
  destruct (taken_ok w WF pc t tmodel Ht P P' HP (sbody_of a) (sbody_of b) F G (placed_ok 0 _ _ HF) (placed_ok 0 _ _ HG) Hb rx ry rz R)
    as (M & HM & X & L). cbn [sbody_of sb_frame] in X.
  assert (MEET : forall x, inside (body_geometry a) x -> inside (body_geometry b) (M x) ->
    exists y z, occupies P a F y /\ occupies P b G z /\ y = z).
  { intros x Ia Ib. exists (P (body_frame a) (F x)), (P (body_frame a) (F x)). split; [exists x; auto|].
    split; [|reflexivity]. exists (M x). split; [exact Ib|]. symmetry. apply X. }
  unfold shows in H. destruct wt as [piece edge crossed | p container four | p q]; cbn [only_near].
  - destruct (corners_of (body_geometry a) piece) as [[|a0 [|a1 [|a2 [|]]]]|] eqn:CA; try discriminate.
    destruct (corners_of (body_geometry b) crossed) as [[|b0 [|b1 [|b2 [|]]]]|] eqn:CB; try discriminate.
    destruct (edge_of edge a0 a1 a2) as [p q] eqn:E.
    destruct (crosses_ok _ _ _ _ _ _ _ _ _ _ (HM _ _ (holdsv_point 0 p)) (HM _ _ (holdsv_point 0 q)) (holdsv_point 0 b0)
      (holdsv_point 0 b1) (holdsv_point 0 b2) H) as (l & Hl & IB). rewrite <- L in IB.
    apply (MEET (add (scale l (point q)) (scale (1 - l) (point p)))).
    + eapply corners_of_ok; [exact CA|].
      apply between; [| | exact Hl]; apply corner; cbn [map In]; destruct edge as [|[|]]; injection E as <- <-; auto.
    + eapply corners_of_ok; [exact CB | exact IB].
  - destruct (point_of (body_geometry a) p) as [m|] eqn:PO; [|discriminate].
    destruct (point_of_ok _ _ _ PO) as (x & Hx & Ia). apply (MEET x Ia). eapply in_shape_ok; [exact H | apply HM; exact Hx].
  - destruct (point_of (body_geometry a) p) as [m|] eqn:PA; [|discriminate].
    destruct (point_of (body_geometry b) q) as [n|] eqn:PB; [|discriminate].
    destruct (point_of_ok _ _ _ PA) as (x & Hx & Ia). destruct (point_of_ok _ _ _ PB) as (y & Hy & Ib).
    exists (P (body_frame a) (F x)), (P (body_frame b) (G y)). split; [exists x; auto|]. split; [exists y; auto|].
    rewrite <- X, (frame_keeps w WF pc t tmodel Ht P P' HP (body_frame b) (body_frame b) (le_n _) Hb).
    rewrite (step_keeps 0 _ _ _ _ (placed_ok 0 _ _ HG)).
    pose proof (holdsv_sub _ _ _ _ (HM _ _ Hx) Hy) as (D1 & D2 & D3).
    exact (squares_ok _ _ _ _ _ _ (size_ok _ _ D1) (size_ok _ _ D2) (size_ok _ _ D3) H (Rle_refl _)).
Qed.

Theorem meets_ok_sound w m k i j t first wt : well_formed w -> meets_ok w m k i j t first wt = true ->
  meets w m (only_near wt) k i j t.
Proof.
  intros WF. unfold meets_ok. destruct (nth_error (pieces m) k) as [p|] eqn:Np; [|discriminate].
  destruct (nth_error (bodies w) i) as [a|] eqn:Na; [|discriminate].
  destruct (nth_error (bodies w) j) as [b|] eqn:Nb; [|discriminate].
  rewrite !andb_true_iff, !Z.leb_le, Nat.ltb_lt, forallb_forall. intros [[[[[Hij C] T0] T1] HI] H].
  exists p, a, b. repeat (split; [assumption|]). split; [|split].
  - split.
    + unfold real. apply Rmult_le_pos; [apply IZR_le; exact T0 | left; apply powerRZ_lt; lra].
    + pose proof (number_up_ok t). apply V_le in T1. rewrite V_one in T1. lra.
  - intros u I. specialize (HI _ I). cbv beta iota in HI. rewrite !Nat.eqb_refl in HI. cbn [andb negb orb] in HI.
    apply Z.ltb_lt, V_lt in HI. pose proof (number_up_ok u). pose proof (number_down_ok t). lra.
  - intros P P' A B HP HA HB.
    assert (Fa : (body_frame a <= length (frames w))%nat) by (apply (proj2 WF); exact (nth_error_In _ _ Na)).
    assert (Fb : (body_frame b <= length (frames w))%nat) by (apply (proj2 WF); exact (nth_error_In _ _ Nb)).
    pose proof (margin_down_ok w m a b) as MD. cbv zeta in H. destruct first.
    + destruct (meet_at_ok w p _ _ P P' a b A B _ wt WF Fb (holds_number 0 t) HP HA HB H) as (x & y & X & Y & Q).
      exists x, y. split; [exact X|]. split; [exact Y|]. destruct (only_near wt); [lra | exact Q].
    + destruct (meet_at_ok w p _ _ P P' b a B A _ wt WF Fa (holds_number 0 t) HP HB HA H) as (x & y & X & Y & Q).
      exists y, x. split; [exact Y|]. split; [exact X|]. destruct (only_near wt); [|symmetry; exact Q].
      replace (norm (sub y x)) with (norm (sub x y)); [lra|]. apply norm_of_dots.
      unfold dot, sub, add, scale; cbn [vx vy vz]. ring.
Qed.
